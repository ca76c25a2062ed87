"""Whole traces that a cable may have, put together from searches from both of its ends.

A path from the start is one; so is a path from another end that came to the start, turned
round. Where one runs along the other for a while, either may be right before and after, so
both ways of changing over are traces, too. Paths that were lost half-way join there.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from perception.cable.tracers.paths import Detour, Path
from perception.cable.tracers.starts import from_start
from perception.cable.tracers.survey import Survey
from perception.cable.types import TraceEnd
from perception.models.frames import Floats
from perception.models.tracer_crop import STEP, WIDTH

# Paths of one search, other ways of each, and traces in all that are looked at.
MOST_PATHS, MOST_DETOURS, MOST = 4, 2, 16
# What no search has found is as unlikely as this for it [nats].
FLOOR = -6.0
# Two lines run together where they are this near, with directions alike.
TOGETHER = 0.8 * WIDTH
TURNED = 1.5 * WIDTH
# They do so for this many points at least, and may miss each other for as many between.
LEAST_RUN = 3


@dataclass(frozen=True, slots=True, eq=False)
class Hypothesis:
    """One whole trace from a start.

    Attributes:
        points: In the scaled image, about one step apart, shape (N, 2).
        end: Why it ends.
        reached: Number of the end that it has come to, None for none that is known.
        there: Logarithm of the belief of the search from the start.
        back: The same of the search from the end that it has come to; 0 without one.
        joined: Whether it is put together from two paths.
    """

    points: Floats
    end: TraceEnd
    reached: int | None
    there: float = FLOOR
    back: float = FLOOR
    joined: bool = False


def hypotheses(survey: Survey, start: int) -> tuple[Hypothesis, ...]:
    """Return distinct traces from a start, those that searches believe in most first.

    Args:
        survey: Searches from all ends.
        start: Number of the end to start from.
    """
    kept: list[Hypothesis] = []
    for new in _all(survey, start):
        for number, old in enumerate(kept):
            if same(old, new):
                kept[number] = replace(
                    old, there=max(old.there, new.there), back=max(old.back, new.back)
                )
                break
        else:
            kept.append(new)
    kept = [replace(one, back=0.0) if one.reached is None else one for one in kept]
    return tuple(sorted(kept, key=lambda one: -(one.there + one.back)))[:MOST]


def _all(survey: Survey, start: int) -> Iterator[Hypothesis]:
    ahead = [
        Hypothesis(
            from_start(survey.ends.points[start], path.points),
            path.end or TraceEnd.LOST,
            _reached(survey, path),
            there=belief,
        )
        for path, belief in believed(survey.found[start])
    ]
    back = []
    for number, found in enumerate(survey.found):
        if number == start:
            continue
        for path, belief in believed(found):
            points = from_start(survey.ends.points[number], path.points)[::-1]
            turned = Hypothesis(points, TraceEnd.ENDPOINT, number, back=belief)
            back.append((turned, _reached(survey, path) == start))
    yield from ahead
    yield from (turned for turned, whole in back if whole)
    for one in ahead:
        for other, whole in back:
            yield from joins(one, other, whole)


def believed(paths: Sequence[Path]) -> list[tuple[Path, float]]:
    """Return the likeliest paths and other ways of theirs, with logarithms of their beliefs."""
    ways = [
        way
        for path in paths[:MOST_PATHS]
        for way in (
            path,
            *(path.along(d) for d in sorted(path.detours, key=_loss)[:MOST_DETOURS]),
        )
    ]
    if not ways:
        return []
    logs = np.array([way.log_probability for way in ways])
    logs -= np.logaddexp.reduce(logs)
    return [(way, max(float(log), FLOOR)) for way, log in zip(ways, logs, strict=True)]


def _loss(detour: Detour) -> float:
    return detour.loss


def _reached(survey: Survey, path: Path) -> int | None:
    """Return the number of the known end that a path has come to."""
    if path.end is not TraceEnd.ENDPOINT or not len(survey.ends.points):
        return None
    gaps = np.linalg.norm(survey.ends.points - path.points[-1], axis=1)
    return int(gaps.argmin()) if gaps.min() < 0.5 * WIDTH else None


def joins(one: Hypothesis, other: Hypothesis, whole: bool) -> Iterator[Hypothesis]:
    """Yield traces that go along one and change to the other where both run together.

    Args:
        one: From the start.
        other: To its end.
        whole: Whether the other one begins at the start, too.
    """
    near = apart(one.points, other.points) < TOGETHER
    runs = _runs(near)
    # Traces that are together from start to end give nothing new.
    if not runs or (whole and len(runs) == 1 and len(runs[0]) > 0.9 * len(one.points)):
        return
    for run in runs:
        i, j = run[len(run) // 2]
        yield replace(
            other,
            points=np.vstack([one.points[: i + 1], other.points[j + 1 :]]),
            back=FLOOR,
            joined=True,
        )
        if whole:
            yield replace(
                one,
                points=np.vstack([other.points[: j + 1], one.points[i + 1 :]]),
                there=FLOOR,
                joined=True,
            )


def _runs(near: NDArray[np.bool_]) -> list[list[tuple[int, int]]]:
    """Return pairs of points along which two lines run together, the same way round."""
    runs: list[list[tuple[int, int]]] = []
    current: list[tuple[int, int]] = []
    for i in range(len(near)):
        places = np.flatnonzero(near[i])
        if current:
            last_i, last_j = current[-1]
            places = places[(places >= last_j) & (places <= last_j + LEAST_RUN)]
            if not len(places):
                if i - last_i > LEAST_RUN:
                    runs, current = [*runs, current], []
                continue
        if len(places):
            current.append((i, int(places[0])))
    runs.append(current)
    return [run for run in runs if len(run) >= LEAST_RUN]


def same(a: Hypothesis, b: Hypothesis) -> bool:
    """Say whether two traces follow the same cable the same way."""
    if a.reached != b.reached or abs(len(a.points) - len(b.points)) > 0.1 * len(a.points) + 3:
        return False
    gaps = apart(a.points, b.points)
    # Ends differ by what was known of them.
    inner = gaps[2:-2, :], gaps[:, 2:-2]
    return bool(
        inner[0].min(axis=1).max(initial=0.0) < STEP
        and inner[1].min(axis=0).max(initial=0.0) < STEP
    )


def apart(a: Floats, b: Floats) -> Floats:
    """Return how far points of two lines are apart, more where directions differ, (N, M)."""
    gaps = cdist(a, b)
    turned: Floats = gaps + TURNED * (1.0 - _headings(a) @ _headings(b).T)
    return turned


def _headings(points: Floats) -> Floats:
    steps = np.gradient(points, axis=0)
    unit: Floats = steps / np.maximum(np.linalg.norm(steps, axis=1, keepdims=True), 1e-9)
    return unit
