"""The analytic tracer of SGTM 2.0 (Shivakumar et al. 2022), made robust and deterministic.

From each point, rings of growing radius are searched for the next points on the mask; every
choice becomes a path of its own, and the finished path that bends least and explains most of
the mask wins. Work is capped by the number of paths that are looked at, not by time.
"""

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from perception.cable.endpoints import leaves_view
from perception.cable.mask import CableMask
from perception.cable.observation import Observe, observe
from perception.cable.types import Endpoint, Points, Trace, TraceEnd
from perception.camera import GreyImage


@dataclass(frozen=True, slots=True)
class AnalyticConfig:
    """Settings of the analytic tracer.

    Attributes:
        rings_px: Radii at which the next point is looked for, nearest first.
        fan_rad: Half opening of the fan of directions.
        step_rad: Step between directions.
        dark_share: Largest share of a step that may run outside of the mask.
        samples: Points of a step that are checked.
        merge_cosine: Candidates closer than this are one.
        visited_px: A path may not come back to within this of its own points, except crosswise.
        most_paths: How many paths are looked at.
        beam: How many paths are carried on at a time.
        endpoint_px: A path that comes this near to an endpoint is finished.
        border_px: One that comes this near to the border has left the view.
        bend_weight: Cost of the mean squared turn.
        coverage_px: Mask that is this far from the path is not explained.
    """

    rings_px: tuple[float, ...] = (16.0, 24.0, 32.0)
    fan_rad: float = 1.45
    step_rad: float = 0.07
    dark_share: float = 0.3
    samples: int = 10
    merge_cosine: float = 0.97
    visited_px: float = 4.0
    most_paths: int = 2500
    beam: int = 24
    endpoint_px: float = 20.0
    border_px: float = 9.0
    bend_weight: float = 5.0
    coverage_px: float = 30.0


@dataclass(frozen=True, slots=True, eq=False)
class _Path:
    """A path so far: its points, its turns, and the length since its start."""

    points: tuple[tuple[float, float], ...]
    turns: tuple[float, ...]

    def extended(self, point: Points, turn: float) -> "_Path":
        return _Path((*self.points, (float(point[0]), float(point[1]))), (*self.turns, turn))

    @property
    def bend(self) -> float:
        return float(np.mean(np.square(self.turns))) if self.turns else 0.0


class AnalyticTracer:
    """Implements `Tracer` by searching all paths of steps over the mask.

    Args:
        config: Settings.
        observe: Looks at an image.
    """

    def __init__(self, config: AnalyticConfig | None = None, observe: Observe = observe) -> None:
        self._config, self._observe = config or AnalyticConfig(), observe

    def trace(
        self, image: GreyImage, start_px: Points, endpoints: Sequence[Endpoint]
    ) -> Trace | None:
        """Follow the cable; see `Tracer.trace`."""
        observation = self._observe(image)
        if observation is None:
            return None
        search = _Search(observation.mask, endpoints, self._config)
        start = search.begin(np.atleast_2d(np.asarray(start_px, dtype=float)))
        return search.run(start) if start is not None else None

    def steps(
        self, image: GreyImage, start_px: Points, direction: Points, count: int
    ) -> Points | None:
        """Take a few steps from a point, shape (count + 1, 2).

        Returns:
            The points, or None where the way is not clear: it stops, or it parts.
        """
        observation = self._observe(image)
        if observation is None:
            return None
        search = _Search(observation.mask, (), self._config)
        ahead = start_px + 4.0 * np.asarray(direction, dtype=float)
        path = search.begin(np.stack([start_px, ahead]))
        points = [np.asarray(start_px, dtype=float)]
        while path is not None and len(points) <= count:
            candidates = search.successors(path)
            if len(candidates) != 1:
                return None
            path = candidates[0]
            points.append(np.array(path.points[-1]))
        return np.array(points) if path is not None else None


class _Search:
    """One search over one mask."""

    def __init__(
        self, mask: CableMask, endpoints: Sequence[Endpoint], config: AnalyticConfig
    ) -> None:
        self.mask, self.config = mask, config
        self.ends = np.array([endpoint.position_px for endpoint in endpoints]).reshape(-1, 2)
        self.cable_px = np.argwhere(mask.cable)[::7, ::-1].astype(float)
        fan = np.arange(0.0, config.fan_rad, config.step_rad)
        self.angles = np.concatenate([-fan[:0:-1], fan])

    def begin(self, start_px: Points) -> _Path | None:
        """Return the path of the first points; a lone point is given the clearest direction."""
        if not self._is_cable(start_px[:1]).any():
            near = self.cable_px[np.argmin(np.linalg.norm(self.cable_px - start_px[0], axis=1))]
            if np.linalg.norm(near - start_px[0]) > self.config.rings_px[0]:
                return None
            start_px = np.concatenate([near[None], start_px[1:]])
        if len(start_px) == 1:
            circle = np.arange(0.0, 2.0 * math.pi, self.config.step_rad)
            ways = np.column_stack([np.cos(circle), np.sin(circle)])
            seen = self._share(start_px[0], ways * self.config.rings_px[0])
            start_px = np.stack([start_px[0], start_px[0] + 4.0 * ways[int(np.argmax(seen))]])
        return _Path(tuple((float(x), float(y)) for x, y in start_px), ())

    def run(self, start: _Path) -> Trace:
        """Carry paths on until the cap is reached; the best one is the trace."""
        queue, done = deque([start]), []
        looked_at = 0
        while queue and looked_at < self.config.most_paths:
            looked_at += 1
            path = queue.popleft()
            end = self._end(path, start)
            successors = [] if end is not None else self.successors(path)
            if not successors:
                done.append((path, end or TraceEnd.LOST))
            queue.extend(successors)
            if len(queue) > 2 * self.config.beam:
                queue = deque(self._thin_out(list(queue)))
        done += [(path, TraceEnd.LOST) for path in queue]
        return self._best(done)

    def successors(self, path: _Path) -> list[_Path]:
        """Return the path with one more point, once for each way that it may go."""
        here, heading = np.array(path.points[-1]), self._heading(path)
        for ring_px in self.config.rings_px:
            directions = heading + self.angles
            steps = ring_px * np.column_stack([np.cos(directions), np.sin(directions)])
            clear = self._share(here, steps) >= 1.0 - self.config.dark_share
            clear &= self._is_cable(here + steps) & ~self._visited(path, here + steps)
            chosen = self._middles(clear)
            if chosen:
                return [path.extended(here + steps[k], float(self.angles[k])) for k in chosen]
        return []

    def _heading(self, path: _Path) -> float:
        (ax, ay), (bx, by) = path.points[-2:]
        return math.atan2(by - ay, bx - ax)

    def _middles(self, clear: "np.ndarray[tuple[int], np.dtype[np.bool_]]") -> list[int]:
        """Return the middle of each run of clear directions; near ones are merged."""
        edges = np.flatnonzero(np.diff(np.concatenate([[False], clear, [False]]).astype(int)))
        middles = [(a + b - 1) // 2 for a, b in zip(edges[::2], edges[1::2], strict=True)]
        apart = math.acos(self.config.merge_cosine)
        kept: list[int] = []
        for k in sorted(middles, key=lambda k: abs(self.angles[k])):
            if all(abs(self.angles[k] - self.angles[m]) > apart for m in kept):
                kept.append(int(k))
        return kept

    def _is_cable(self, points_px: Points) -> "np.ndarray[tuple[int, ...], np.dtype[np.bool_]]":
        height, width = self.mask.cable.shape
        x, y = np.rint(points_px[..., 0]).astype(int), np.rint(points_px[..., 1]).astype(int)
        inside = (x >= 0) & (y >= 0) & (x < width) & (y < height)
        hit: np.ndarray[tuple[int, ...], np.dtype[np.bool_]] = (
            inside & self.mask.cable[np.clip(y, 0, height - 1), np.clip(x, 0, width - 1)]
        )
        return hit

    def _share(self, here: Points, steps: Points) -> Points:
        """Return how much of each step runs over cable."""
        along = np.linspace(0.1, 1.0, self.config.samples)[:, None, None]
        share: Points = self._is_cable(here + along * steps).mean(axis=0)
        return share

    def _visited(
        self, path: _Path, points_px: Points
    ) -> "np.ndarray[tuple[int], np.dtype[np.bool_]]":
        """Say which points lie where the path has been already, running the same way."""
        old = np.array(path.points[:-2]).reshape(-1, 2)
        if len(old) < 2:
            return np.zeros(len(points_px), dtype=bool)
        gaps = np.linalg.norm(points_px[:, None] - old[None], axis=2)
        near: np.ndarray[tuple[int], np.dtype[np.bool_]] = gaps.min(axis=1) < self.config.visited_px
        return near

    def _end(self, path: _Path, start: _Path) -> TraceEnd | None:
        """Return why a path is finished, or None."""
        here = np.array(path.points[-1])
        if len(path.points) - len(start.points) > 8:
            gaps = np.linalg.norm(self.ends - here, axis=1)
            if len(gaps) and gaps.min() < self.config.endpoint_px:
                return TraceEnd.ENDPOINT
        if len(path.points) > len(start.points) and leaves_view(
            self.mask, here, self.config.border_px + self.config.rings_px[0]
        ):
            return TraceEnd.EDGE
        return TraceEnd.RETRACE if self._retraces(path) else None

    def _retraces(self, path: _Path) -> bool:
        """Say whether the last points run along earlier ones."""
        last = 5
        if len(path.points) < 3 * last:
            return False
        old, new = np.array(path.points[: -2 * last]), np.array(path.points[-last:])
        gaps = np.linalg.norm(new[:, None] - old[None], axis=2).min(axis=1)
        return bool((gaps < 0.5 * self.config.rings_px[0]).all())

    def _thin_out(self, paths: list[_Path]) -> list[_Path]:
        """Keep the straightest paths, one for each place that they have come to."""
        kept: dict[tuple[int, int, int], _Path] = {}
        for path in sorted(paths, key=lambda path: path.bend):
            x, y = path.points[-1]
            kept.setdefault((int(x // 12), int(y // 12), len(path.points) // 6), path)
        return list(kept.values())[: self.config.beam]

    def _best(self, done: list[tuple[_Path, TraceEnd]]) -> Trace:
        """Score finished paths; only if there are none, the unfinished ones."""
        finished = [item for item in done if item[1] in (TraceEnd.ENDPOINT, TraceEnd.EDGE)]
        pool = finished or done
        scores = np.array([self._score(path) for path, _ in pool])
        best = int(np.argmax(scores))
        weights = np.exp(4.0 * (scores - scores[best]))
        path, end = pool[best]
        return Trace(np.array(path.points), end, float(1.0 / weights.sum()))

    def _score(self, path: _Path) -> float:
        """Return -5 times the mean squared turn, less what of the mask is not explained."""
        gaps, _ = cKDTree(np.array(path.points)).query(self.cable_px)
        farthest = float(np.max(gaps))
        coverage = -farthest / 15.0 if farthest > self.config.coverage_px else 0.0
        return coverage - self.config.bend_weight * path.bend
