"""Partial traces of a search: where they are, how likely, and whether they must end."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from perception.cable.types import Endpoint, TraceEnd
from perception.models.frames import ScaledImage
from perception.models.tracer_crop import STEP, WIDTH

Floats = NDArray[np.float64]

# A path that runs along itself for this many points goes over the same cable again.
REPEATED = 8
REPEAT_DISTANCE = 0.75 * WIDTH
# Cable does not lie on itself for so long; such a path went wrong somewhere.
REPEAT_PROBABILITY = 0.02
# A path ends at an end that lies so far ahead and aside, and that faces it.
ENDPOINT_AHEAD = 2.2 * WIDTH
ENDPOINT_ASIDE = 0.9 * WIDTH
ENDPOINT_FACING = 0.5
# It surely does so where the end is believed in as much; at others it may go on.
SURE_END = 0.9
EDGE_MARGIN = 0.5 * WIDTH


@dataclass(frozen=True, slots=True, eq=False)
class Detour:
    """Another way between two points of a path, which met it again and was less likely.

    Attributes:
        first: The path's point after which they part.
        last: The path's point at which they are together again.
        points: The other way in between, shape (K, 2).
        loss: How much less likely it is [nats].
    """

    first: int
    last: int
    points: Floats
    loss: float

    def moved(self, by: int) -> "Detour":
        """Return the same of a path with so many more points before it."""
        return replace(self, first=self.first + by, last=self.last + by)


@dataclass(frozen=True, slots=True, eq=False)
class Path:
    """A partial trace in the scaled image.

    Attributes:
        points: About one step apart, shape (N, 2), N >= 2.
        logs: Logarithm of the probability of all choices up to each point, shape (N,).
        end: Why it has ended, None while it goes on.
        detours: Other ways that were found between two of its points.
    """

    points: Floats
    logs: Floats
    end: TraceEnd | None = None
    detours: tuple[Detour, ...] = ()

    @property
    def heading(self) -> Floats:
        """Unit vector of the last step."""
        step = self.points[-1] - self.points[-2]
        direction: Floats = step / max(float(np.linalg.norm(step)), 1e-9)
        return direction

    @property
    def log_probability(self) -> float:
        """Logarithm of the probability of all choices."""
        return float(self.logs[-1])

    def extended(self, point: Floats, probability: float) -> "Path":
        """Return the path with one more point."""
        logs = np.append(self.logs, self.logs[-1] + np.log(probability))
        return replace(self, points=np.vstack([self.points, point]), logs=logs)

    def ended(self, end: TraceEnd, probability: float = 1.0) -> "Path":
        """Return the path as one that has ended."""
        logs = self.logs.copy()
        logs[-1] += np.log(probability)
        return replace(self, end=end, logs=logs)

    def shortened(self, points: int) -> "Path":
        """Return the path without its last points."""
        left = len(self.points) - points
        kept = tuple(detour for detour in self.detours if detour.last < left)
        return replace(self, points=self.points[:left], logs=self.logs[:left], detours=kept)

    def lifted(self, first: int, by: float) -> "Path":
        """Return the path with other logarithms from a point on."""
        logs = self.logs.copy()
        logs[first:] += by
        return replace(self, logs=logs)

    def joined(self, other: "Path", place: int) -> "Path":
        """Return this path continued by what comes after point `place` of another one."""
        ahead = other.logs[place + 1 :] - other.logs[place]
        more = len(self.points) - 1 - place
        later = tuple(d.moved(more) for d in other.detours if d.first >= place)
        return Path(
            np.vstack([self.points, other.points[place + 1 :]]),
            np.concatenate([self.logs, self.logs[-1] + ahead]),
            other.end,
            self.detours + later,
        )

    def passed_by(self, detour: Detour) -> "Path":
        """Return the path with another way that it might have gone."""
        return replace(self, detours=(*self.detours, detour))

    def along(self, detour: Detour) -> "Path":
        """Return the path that goes one of its other ways."""
        points = np.vstack(
            [self.points[: detour.first + 1], detour.points, self.points[detour.last :]]
        )
        logs = np.full(len(points), self.logs[-1] - detour.loss)
        return Path(points, logs, self.end)


@dataclass(frozen=True, slots=True, eq=False)
class Ends:
    """Ends of cables where a path may finish, in the scaled image.

    Attributes:
        points: Where, shape (K, 2).
        directions: Unit vectors into the cable, shape (K, 2).
        beliefs: Beliefs that they are ends, shape (K,).
    """

    points: Floats
    directions: Floats
    beliefs: Floats

    @classmethod
    def of(cls, endpoints: Sequence[Endpoint], scaled: ScaledImage) -> "Ends":
        """Return ends of the original image in a scaled one."""
        return cls(
            scaled.into(np.array([end.position_px for end in endpoints]).reshape(-1, 2)),
            np.array([end.direction for end in endpoints]).reshape(-1, 2),
            np.array([end.probability for end in endpoints], dtype=float),
        )

    def without(self, place: Floats, near: float) -> "Ends":
        """Return the ends that are not near a place."""
        far = np.linalg.norm(self.points - place, axis=1) > near
        return Ends(self.points[far], self.directions[far], self.beliefs[far])

    def reached(self, path: Path) -> int | None:
        """Return the number of the end that a path has come to, None if it has come to none."""
        heading = path.heading
        offsets = self.points - path.points[-1]
        ahead = offsets @ heading
        aside = np.abs(offsets @ np.array([-heading[1], heading[0]]))
        near = (np.abs(ahead) < ENDPOINT_AHEAD) & (aside < ENDPOINT_ASIDE)
        facing = self.directions @ heading < -ENDPOINT_FACING
        found = np.flatnonzero(near & facing)
        return int(found[aside[found].argmin()]) if len(found) else None

    def doubtful(self, path: Path) -> int | None:
        """Return the number of an end right ahead of a path at which it may also go on."""
        number = self.reached(path)
        if number is None or self.beliefs[number] >= SURE_END:
            return None
        ahead = float((self.points[number] - path.points[-1]) @ path.heading)
        return number if ahead > 0.0 else None


def checked(path: Path, image: ScaledImage, ends: Ends) -> Path:
    """Return the path, ended where it reaches a sure end of a cable, the border or itself."""
    if path.end is not None:
        return path
    here = path.points[-1]
    if (here < EDGE_MARGIN).any() or (here > image.size - 1 - EDGE_MARGIN).any():
        return path.ended(TraceEnd.EDGE)
    end = ends.reached(path)
    if end is not None and ends.beliefs[end] >= SURE_END:
        return path.extended(ends.points[end], 1.0).ended(TraceEnd.ENDPOINT)
    if repeats(path.points):
        return path.shortened(REPEATED).ended(TraceEnd.RETRACE, REPEAT_PROBABILITY)
    return path


def repeats(points: Floats) -> bool:
    """Say whether the last points run along earlier ones, either way round."""
    if len(points) < 2 * REPEATED + 2:
        return False
    last, earlier = points[-REPEATED:], points[: -REPEATED - 2]
    for index in np.flatnonzero(np.linalg.norm(earlier - last[0], axis=1) < 1.2 * STEP):
        ahead = earlier[max(index - 1, 0) : index + REPEATED + 1]
        behind = earlier[max(index - REPEATED, 0) : index + 2]
        for line in (ahead, behind):
            if len(line) >= REPEATED and distances(last, line).max() < REPEAT_DISTANCE:
                return True
    return False


def distances(points: Floats, line: Floats) -> Floats:
    """Return the distance of each point from a polyline, shape (N,)."""
    start, along = line[:-1], np.diff(line, axis=0)
    squares = np.maximum((along**2).sum(1), 1e-9)
    offsets = points[:, None] - start[None]
    shares = np.clip((offsets * along).sum(2) / squares, 0.0, 1.0)
    gaps: Floats = np.linalg.norm(offsets - shares[:, :, None] * along, axis=2).min(axis=1)
    return gaps
