"""Knots of a size as the core of a cable, tied, or the same shape with nothing tied in it."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from benchmarks.knot_truth import visits_of
from benchmarks.laying import Core, turned
from perception.cable.topology import Strand
from perception.cable.topology.curve import self_intersections
from perception.cable.topology.rule import uncancelled_intervals
from perception.training.waypoints import resample
from simulation.cable.knots import TEMPLATES, KnotName, KnotTemplate, fake_overs

Floats = NDArray[np.float64]

# Cable that is laid with a knot before its first and after its last crossing, and distance of
# waypoints [cable widths].
BEYOND, WAYPOINTS = 4.0, 1.5


def knot_core(
    rng: np.random.Generator, knot: KnotName, diameter: float, place: Floats, *, tied: bool
) -> Core:
    """Return a knot of a size, turned and mirrored at random, or the same shape untied.

    Args:
        rng: Source of all randomness.
        knot: Which knot.
        diameter: Largest distance between two points of its closed part [cable widths].
        place: Where its middle lies.
        tied: Whether it is knotted; else it is proved not to be, and yet looks like a knot to
            who cancels no crossings.
    """
    template = TEMPLATES[knot]
    over = template.over if tied else _untied(rng, template)
    points, low, high, size = _measured(template)
    points = points * (diameter / size) * (1.0, rng.choice([-1.0, 1.0]))
    points = resample(_trimmed(points, low, high), WAYPOINTS)
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    mirrored = bool(rng.random() < 0.5)
    return Core(place + turned(rng, points - middle), tuple(o != mirrored for o in over))


def closed_diameter(points: Floats) -> float:
    """Return the largest distance between two points from the first to the last crossing."""
    low, high = _closed(points)
    closed = points[low : high + 1]
    return float(np.linalg.norm(closed[:, None] - closed[None], axis=2).max())


@cache
def _measured(template: KnotTemplate) -> tuple[Floats, int, int, float]:
    """Return a template's curve, between which nodes it is closed, and how large there."""
    points = template.curve_m(1.0, 0.004)
    return points, *_closed(points), closed_diameter(points)


def _untied(rng: np.random.Generator, template: KnotTemplate) -> tuple[bool, ...]:
    """Return over and under for each visit such that nothing is tied, but seems to be."""
    seeming = [over for over in fake_overs(template) if _seems_knotted(template.strand(over))]
    return seeming[int(rng.integers(len(seeming)))]


def _seems_knotted(strand: Strand) -> bool:
    return bool(uncancelled_intervals(visits_of(strand)))


def _closed(points: Floats) -> tuple[int, int]:
    """Return the nodes before the first and after the last crossing."""
    first, second, _ = self_intersections(points)
    return int(first.min()), int(second.max()) + 1


def _trimmed(points: Floats, low: int, high: int) -> Floats:
    """Return a curve from a little before its first to a little after its last crossing."""
    reach = max(int(BEYOND / float(np.linalg.norm(points[1] - points[0]))), 2)
    return points[max(low - reach, 0) : high + reach + 1]
