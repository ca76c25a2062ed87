"""Paths of a search that part and meet again: one of them is kept, by belief and by coverage.

From where two paths run together again they have one future, so only one needs to be
followed. The network rates each step by itself; it cannot know that a shorter way leaves a
loop of cable that nothing explains. That is weighed here: each step's length of cable that
only one of both ways covers speaks for it.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from perception.cable.tracers.paths import Detour, Path, distances
from perception.models.tracer_crop import STEP, WIDTH

Floats = NDArray[np.float64]

# Strands that cross at a small angle are at one place with nearly one direction for a while.
TOGETHER = 3
TOGETHER_DISTANCE = 0.45 * WIDTH
COVERED_DISTANCE = 0.7 * WIDTH


@dataclass(frozen=True, slots=True)
class RivalConfig:
    """How coverage is weighed against belief.

    Attributes:
        gain: For each step's length of cable that only one of two ways covers [nats].
        most: At most so much in all [nats].
    """

    gain: float = 0.35
    most: float = 3.0


def reduced(paths: list[Path], config: RivalConfig) -> list[Path]:
    """Return paths, likeliest first, of which no two run together at the end of one."""
    kept: list[Path] = []
    for path in paths:
        for index, other in enumerate(kept):
            one = _one_of(path, other, config) or _one_of(other, path, config)
            if one is not None:
                kept[index] = one
                break
        else:
            kept.append(path)
    return sorted(kept, key=lambda path: -path.log_probability)


def _one_of(path: Path, other: Path, config: RivalConfig) -> Path | None:
    """Return the better of two paths if `path` ends where `other` passes, None if not."""
    place = meeting(path, other)
    if place is None:
        return None
    advantage = _advantage(path, other, place, config)
    # Both ways together are as likely as before; the advantage says how they share that.
    both = float(np.logaddexp(path.logs[-1], other.logs[place]))
    share = both - float(np.log1p(np.exp(-abs(advantage))))
    apart, last = parting(path, other), len(path.points) - 1
    if advantage > 0.0:
        kept = path.joined(other, place).lifted(last, share - float(path.logs[-1]))
        return kept.passed_by(Detour(apart - 1, last, other.points[apart:place], advantage))
    kept = other.lifted(place, share - float(other.logs[place]))
    return kept.passed_by(Detour(apart - 1, place, path.points[apart:last], -advantage))


def meeting(path: Path, other: Path) -> int | None:
    """Return the point of `other` that the end of `path` has reached, None if not together."""
    apart = parting(path, other)
    if apart > len(path.points) - TOGETHER or apart >= len(other.points) - 1:
        return None
    tail = path.points[-TOGETHER:]
    gaps = np.linalg.norm(other.points[apart:] - tail[-1], axis=1)
    place = apart + int(gaps.argmin())
    if gaps.min() > 0.6 * STEP or place < 1:
        return None
    window = other.points[max(place - TOGETHER - 1, 0) : place + 2]
    step = other.points[place] - other.points[place - 1]
    same_way = float(step @ path.heading) > 0.8 * float(np.linalg.norm(step))
    return place if same_way and distances(tail, window).max() < TOGETHER_DISTANCE else None


def parting(path: Path, other: Path) -> int:
    """Return the first point that two paths do not share."""
    length = min(len(path.points), len(other.points))
    differs = (path.points[:length] != other.points[:length]).any(axis=1)
    return int(differs.argmax()) if differs.any() else length


def _advantage(path: Path, other: Path, place: int, config: RivalConfig) -> float:
    """Return how much likelier `path` is than `other` up to where they meet [nats]."""
    apart = max(parting(path, other) - 1, 0)
    belief = float(path.logs[-1] - other.logs[place])
    more = _only(path.points[apart:], other.points) - _only(
        other.points[apart : place + 1], np.vstack([path.points, other.points[place:]])
    )
    return belief + float(np.clip(config.gain * more, -config.most, config.most))


def _only(way: Floats, rest: Floats) -> float:
    """Return how many steps of a way lie off all the rest."""
    return float((distances(way, rest) > COVERED_DISTANCE).sum())
