"""Random smooth curves for the free ends of a cable, laid one arc after another.

An end grows in short arcs of bounded curvature. An arc must keep clear of all that lies there
already; now and then a straight one may cross another strand at a steep angle. Where no arc
fits, the last few are taken back.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Area:
    """Where cable may lie, in the table plane.

    Attributes:
        low_m: Lower corner (x, y).
        high_m: Upper corner (x, y).
    """

    low_m: tuple[float, float]
    high_m: tuple[float, float]

    def contains(self, points_m: Floats) -> bool:
        """Return whether all points (N, 2) lie inside."""
        return bool(self.holds(points_m).all())

    def holds(self, points_m: Floats) -> NDArray[np.bool_]:
        """Say of each point (N, 2) whether it lies inside, shape (N,)."""
        within = (points_m >= self.low_m) & (points_m <= self.high_m)
        return np.asarray(within.all(axis=1))


@dataclass(frozen=True, slots=True)
class LayoutRules:
    """How free ends may run.

    Attributes:
        area: Where they must stay.
        spacing_m: Distance of points on a curve.
        arc_points: Points an arc of constant curvature has.
        clearance_m: Least distance of strands that do not cross.
        end_clearance_m: Least distance of the cable's end from other strands.
        curvature_1_m: Largest curvature.
        bend_1_m: Typical change of curvature from one arc to the next.
        crossing_m: Length of a straight piece that crosses another strand.
        crossing_angle_rad: Least angle of a crossing.
    """

    area: Area
    spacing_m: float = 0.01
    arc_points: int = 6
    clearance_m: float = 0.024
    end_clearance_m: float = 0.035
    curvature_1_m: float = 16.0
    bend_1_m: float = 6.0
    crossing_m: float = 0.09
    crossing_angle_rad: float = 0.9


# Of its neighbour's curvature an arc takes over this share, so that curves do not wind up.
RELAX = 0.7
# An arc is better when it could go on for this many times its length.
LOOK_AHEAD = 3
# How often a strand that could be crossed is crossed, though there may be another way.
BOLDNESS = 0.5
# How often an arc is tried before the last ones are taken back, and how often that may happen.
TRIES = 8
RETREATS = 25


def grow_end(
    curve_m: Floats,
    length_m: float,
    crossings: int,
    rules: LayoutRules,
    rng: np.random.Generator,
) -> Floats | None:
    """Lengthen a curve at its end.

    Args:
        curve_m: What is there of this curve, shape (N, 2); it goes on after its last point.
        length_m: Length to add.
        crossings: How many times the new part may cross what is there.
        rules: How it may run.
        rng: Source of all randomness.

    Returns:
        The longer curve, or None when it got stuck.
    """
    wanted = round(length_m / rules.spacing_m)
    history: list[tuple[Floats, float, int]] = [(curve_m, 0.0, crossings)]
    retreats = 0
    while retreats < RETREATS:
        curve, curvature, left = history[-1]
        grown = len(curve) - len(curve_m)
        done = curve[: len(curve_m) + wanted]
        if grown >= wanted and _end_is_clear(done, rules):
            return done
        step = None if grown >= wanted else _next_arc(curve, curvature, left, rules, rng)
        if step is not None:
            history.append(step)
        else:
            retreats += 1
            del history[max(1, len(history) - int(rng.integers(2, 7))) :]
    return None


def fits_on(piece: Floats, curve: Floats, rules: LayoutRules) -> bool:
    """Return whether a piece that goes on after a curve (N, 2) keeps clear of it."""
    return _clear(piece, curve, rules)


def _next_arc(
    curve: Floats,
    curvature: float,
    crossings: int,
    rules: LayoutRules,
    rng: np.random.Generator,
) -> tuple[Floats, float, int] | None:
    """Return the curve with one more piece, its curvature, and the crossings left."""
    straight = _arc(curve, 0.0, round(rules.crossing_m / rules.spacing_m), rules.spacing_m)
    crosses = (
        crossings > 0 and rules.area.contains(straight) and _crosses_once(straight, curve, rules)
    )
    crossed = np.vstack([curve, straight]), 0.0, crossings - 1
    if crosses and rng.random() < BOLDNESS:
        return crossed
    narrow: tuple[Floats, float, int] | None = None
    for _ in range(TRIES):
        bend = float(rng.normal(RELAX * curvature, rules.bend_1_m))
        bend = min(max(bend, -rules.curvature_1_m), rules.curvature_1_m)
        ahead = _arc(curve, bend, LOOK_AHEAD * rules.arc_points, rules.spacing_m)
        arc = ahead[: rules.arc_points]
        if not (rules.area.contains(arc) and _clear(arc, curve, rules)):
            continue
        narrow = np.vstack([curve, arc]), bend, crossings
        if rules.area.contains(ahead) and _clear(ahead, curve, rules):
            return narrow
    return crossed if crosses else narrow


def _arc(curve: Floats, curvature: float, points: int, spacing: float) -> Floats:
    along = curve[-1] - curve[-2]
    heading = np.arctan2(along[1], along[0])
    headings = heading + curvature * spacing * (np.arange(points) + 0.5)
    steps = spacing * np.column_stack([np.cos(headings), np.sin(headings)])
    return curve[-1] + np.cumsum(steps, axis=0)


def _clear(arc: Floats, curve: Floats, rules: LayoutRules) -> bool:
    """Return whether an arc keeps its distance from everything but what it continues."""
    return _distance(arc, curve[: -_blind_points(rules)]) > rules.clearance_m


def _blind_points(rules: LayoutRules) -> int:
    """Return how much of its own recent past an arc need not keep clear of."""
    return int(2.0 * rules.clearance_m / rules.spacing_m) + rules.arc_points


def _distance(points: Floats, others: Floats) -> float:
    if not len(others):
        return np.inf
    gaps = points[:, None, :] - others[None, :, :]
    return float(np.sqrt(np.einsum("ijk,ijk->ij", gaps, gaps).min()))


def _crosses_once(straight: Floats, curve: Floats, rules: LayoutRules) -> bool:
    """Return whether a straight piece crosses one strand, steeply, with free ends."""
    past = curve[: -_blind_points(rules)]
    if _distance(straight[[0, -1]], past) < 1.3 * rules.clearance_m:
        return False
    angles = _crossing_angles(straight[[0, -1]], past)
    gaps = np.linalg.norm(past[:, None] - straight[None], axis=2).min(axis=1)
    near = np.concatenate([[False], gaps < rules.clearance_m])
    strands = np.count_nonzero(near[1:] & ~near[:-1])
    return len(angles) == 1 and angles[0] > rules.crossing_angle_rad and strands == 1


def _crossing_angles(ends: Floats, line: Floats) -> list[float]:
    """Return the angles [rad] at which a segment crosses a polyline."""
    if len(line) < 2:
        return []
    along = ends[1] - ends[0]
    steps, offset = np.diff(line, axis=0), line[:-1] - ends[0]
    area = along[0] * steps[:, 1] - along[1] * steps[:, 0]
    area = np.where(np.abs(area) < 1e-15, 1e-15, area)
    u = (offset[:, 0] * steps[:, 1] - offset[:, 1] * steps[:, 0]) / area
    v = (offset[:, 0] * along[1] - offset[:, 1] * along[0]) / area
    hit = (u > 0.0) & (u < 1.0) & (v >= 0.0) & (v < 1.0)
    lengths = np.linalg.norm(steps[hit], axis=1) * np.linalg.norm(along)
    return [float(a) for a in np.arcsin(np.clip(np.abs(area[hit]) / lengths, 0.0, 1.0))]


def _end_is_clear(curve: Floats, rules: LayoutRules) -> bool:
    return _distance(curve[-4:], curve[: -_blind_points(rules)]) > rules.end_clearance_m
