"""Centre lines of cables lying on a table, in families, all lengths in cable widths."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from perception.training.settled import hairpin_curve, settled_curve
from perception.training.waypoints import SPACING, resample, through

Points = NDArray[np.float64]


def random_curve(rng: np.random.Generator, extent: float) -> Points:
    """Return a curve through points that keep an exclusion radius from each other."""
    radius = extent * rng.uniform(0.08, 0.3)
    wanted = int(rng.integers(4, 13))
    chosen: list[Points] = []
    for _ in range(12 * wanted):
        point = rng.uniform(-0.1, 1.1, 2) * extent
        if all(np.linalg.norm(point - other) > radius for other in chosen[-3:]):
            chosen.append(point)
        if len(chosen) == wanted:
            break
    return through(np.array(chosen), rng.uniform(1.0, 5.0))


def dense_curve(rng: np.random.Generator, extent: float) -> Points:
    """Return a curve that winds within a small disc and has two tails."""
    middle = rng.uniform(0.3, 0.7, 2) * extent
    size = rng.uniform(3.5, 13.0)
    inner = _template(rng) if rng.random() < 0.6 else _scribble(rng)
    turn = rng.uniform(0.0, 2.0 * np.pi)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    stretch = np.diag([1.0, rng.uniform(0.5, 1.0)]) * size
    knot = inner @ stretch @ rotation.T + middle
    knot += rng.normal(0.0, 0.06 * size, knot.shape)
    return through(
        np.vstack(
            [_tail(rng, knot[0], middle, extent)[::-1], knot, _tail(rng, knot[-1], middle, extent)]
        ),
        rng.uniform(0.4, 1.2),
    )


def coil_curve(rng: np.random.Generator, extent: float) -> Points:
    """Return a curve that winds round several times, as cable does that was rolled up.

    Its turns cross at small angles, and touch without crossing.
    """
    turns = rng.uniform(1.3, 4.5)
    angle = rng.uniform(0.0, 2.0 * np.pi) + np.arange(0.0, 2.0 * np.pi * turns, 0.45)
    radius = extent * rng.uniform(0.06, 0.25)
    wobble = gaussian_filter1d(rng.normal(size=len(angle)), rng.uniform(3.0, 9.0))
    radii = radius * (1.0 + rng.uniform(0.05, 0.3) * wobble / max(float(wobble.std()), 1e-9))
    wander = gaussian_filter1d(rng.normal(size=(len(angle), 2)), 8.0, axis=0)
    wander *= radius * rng.uniform(0.05, 0.4) / max(float(wander.std()), 1e-9)
    drift = np.linspace(0.0, 1.0, len(angle))[:, None] * rng.normal(0.0, 0.4 * radius, 2)
    circle = np.column_stack([np.cos(angle), rng.uniform(0.6, 1.0) * np.sin(angle)])
    middle = rng.uniform(0.3, 0.7, 2) * extent
    coil = middle + radii.clip(2.0, None)[:, None] * circle + wander + drift
    coil = coil[:: rng.choice([1, -1])]
    leaving = [_leave(rng, coil[2] - coil[0], coil[0], extent)[::-1]]
    leaving.append(_leave(rng, coil[-3] - coil[-1], coil[-1], extent))
    return through(np.vstack([leaving[0], coil, leaving[1]]), rng.uniform(0.8, 3.0))


def _leave(rng: np.random.Generator, inwards: Points, start: Points, extent: float) -> Points:
    """Return waypoints that go on from a curve's end with its direction, then wander."""
    heading = np.arctan2(-inwards[1], -inwards[0])
    points = [start]
    for _ in range(int(rng.integers(1, 6))):
        heading += rng.normal(0.0, 0.7)
        step = rng.uniform(0.06, 0.25) * extent
        points.append(points[-1] + step * np.array([np.cos(heading), np.sin(heading)]))
    return np.array(points[1:])


def tight_curve(rng: np.random.Generator, extent: float) -> Points:
    """Return a curve with a knot pulled tight, strands on strands, or a bundle of hairpins."""
    middle = rng.uniform(0.3, 0.7, 2) * extent
    size = rng.uniform(1.8, 5.5)
    turn = rng.uniform(0.0, 2.0 * np.pi)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    inner = _template(rng) if rng.random() < 0.5 else _hairpins(rng)
    stretch = np.array([rng.uniform(1.0, 2.2), rng.uniform(0.35, 1.0)]) * size
    knot = (inner * stretch) @ rotation.T + middle
    knot += rng.normal(0.0, 0.05 * size, knot.shape)
    # A knot that is pulled tight bends the cable less far away from it.
    head, tail = (_leave(rng, knot[a] - knot[b], knot[b], extent) for a, b in ((2, 0), (-3, -1)))
    return through(np.vstack([head[::-1], knot, tail]), rng.uniform(0.35, 0.8))


def _hairpins(rng: np.random.Generator) -> Points:
    """Return waypoints that go there and back several times."""
    count = int(rng.integers(2, 5))
    points = []
    for k in range(count):
        across = (k / max(count - 1, 1) - 0.5) * rng.uniform(0.2, 1.2) + rng.normal(0.0, 0.15)
        ends = np.array([[-1.0, across], [0.0, across], [1.0, across]])
        ends += rng.normal(0.0, 0.12, ends.shape)
        points.append(ends if k % 2 else ends[::-1])
    return np.vstack(points)


def _template(rng: np.random.Generator) -> Points:
    """Return waypoints of a wound curve a cos(nt) + b cos(mt), as diagrams of knots are."""
    turns = rng.choice(4)
    wide, narrow = ((1, 2), (2, 3), (1, 3), (2, 1))[turns]
    span = rng.uniform(1.2, 2.0) * np.pi
    angle = rng.uniform(0.0, 2.0 * np.pi) + np.linspace(0.0, span, int(rng.integers(9, 15)))
    share = rng.uniform(0.35, 1.3)
    sign = rng.choice([-1.0, 1.0])
    x = np.cos(wide * angle) + share * np.cos(narrow * angle)
    y = np.sin(wide * angle) + sign * share * np.sin(narrow * angle)
    return np.column_stack([x, y]) / (1.0 + share)


def _scribble(rng: np.random.Generator) -> Points:
    angles = np.cumsum(rng.uniform(0.6, 2.8, int(rng.integers(5, 13))) * rng.choice([-1.0, 1.0]))
    radii = rng.uniform(0.35, 1.0, len(angles))
    return np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])


def _tail(rng: np.random.Generator, start: Points, middle: Points, extent: float) -> Points:
    """Return waypoints that lead away from a knot."""
    heading = np.arctan2(*(start - middle)[::-1]) + rng.normal(0.0, 0.6)
    points = [start]
    for _ in range(int(rng.integers(2, 6))):
        heading += rng.normal(0.0, 0.6)
        step = rng.uniform(0.1, 0.3) * extent
        points.append(points[-1] + step * np.array([np.cos(heading), np.sin(heading)]))
    return np.array(points[1:])


def parallel_curve(rng: np.random.Generator, extent: float) -> Points:
    """Return a curve that turns round and runs back close along itself."""
    there = random_curve(rng, extent)
    first = int(rng.uniform(0.0, 0.4) * len(there))
    there = there[first : first + int(rng.uniform(30.0, 90.0) / SPACING)]
    back = beside(rng, there)[::-1]
    turn = there[-1] - there[max(len(there) - 8, 0)]
    bulge = there[-1] + turn / max(float(np.linalg.norm(turn)), 1e-6) * rng.uniform(1.0, 8.0)
    bulge += rng.normal(0.0, 1.5, 2)
    waypoints = np.vstack([there[::6], bulge, back[::6]])
    return through(waypoints, rng.uniform(0.5, 4.0))


def beside(rng: np.random.Generator, curve: Points) -> Points:
    """Return a curve that runs close along another one and now and then changes its side."""
    tangent = np.gradient(curve, axis=0)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), 1e-9)
    normal = np.column_stack([-tangent[:, 1], tangent[:, 0]])
    wander = gaussian_filter1d(rng.normal(size=len(curve)), rng.uniform(10.0, 40.0), mode="wrap")
    wander *= rng.uniform(0.3, 2.0) / max(float(wander.std()), 1e-9)
    offset = wander + rng.choice([-1.0, 1.0]) * rng.uniform(0.0, 2.2)
    moved = curve + normal * offset[:, None]
    # Stiff cables change their curvature slowly, also where they touch and part again.
    return resample(gaussian_filter1d(moved, rng.uniform(2.0, 9.0), axis=0, mode="nearest"))


def touching(rng: np.random.Generator, curve: Points) -> Points:
    """Return a curve that comes close to another one, runs beside it and parts again.

    It either touches the other, bending away to its own side, or crosses it at a small angle;
    only the curvature of both tells which.
    """
    reach = int(rng.uniform(8.0, 24.0) / SPACING)
    at = int(rng.integers(0, max(len(curve) - 2 * reach, 1)))
    piece = curve[at : at + 2 * reach]
    along = (np.arange(len(piece)) - 0.5 * len(piece)) * SPACING
    tangent = np.gradient(piece, axis=0)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), 1e-9)
    normal = np.column_stack([-tangent[:, 1], tangent[:, 0]]) * rng.choice([-1.0, 1.0])
    if rng.random() < 0.65:
        offset = rng.uniform(0.8, 1.25) + 0.5 * rng.uniform(0.01, 0.2) * along**2
    else:
        offset = rng.uniform(0.08, 0.5) * along
    beside_it = piece + normal * offset[:, None]
    extent = float(np.ptp(curve, axis=0).max()) + 10.0
    head, tail = (
        _leave(rng, beside_it[a] - beside_it[b], beside_it[b], extent)
        for a, b in ((6, 0), (-7, -1))
    )
    return through(np.vstack([head[::-1], beside_it[::4], tail]), rng.uniform(0.6, 1.5))


def hooked(rng: np.random.Generator, curve: Points) -> Points:
    """Return a curve whose bight lies round some place of another one, as in knots of two.

    It comes from the inner side of the other's bend, goes round it and back to where it came
    from; whether both hold each other is up to which strands lie on top.
    """
    at = int(rng.uniform(0.1, 0.9) * (len(curve) - 9)) + 4
    along = curve[at + 4] - curve[at - 4]
    along /= max(float(np.linalg.norm(along)), 1e-9)
    bend = curve[at + 4] + curve[at - 4] - 2.0 * curve[at]
    away = np.array([-along[1], along[0]])
    away *= -1.0 if away @ bend > 0.0 else 1.0
    apart, reach, depth = rng.uniform(1.0, 3.0), rng.uniform(1.5, 4.0), rng.uniform(3.0, 9.0)
    half = np.array([[-depth, 1.2], [-0.5 * depth, 1.0], [0.0, 1.0], [0.6 * reach, 0.9]])
    bight = np.vstack([half, [[reach, 0.0]], half[::-1] * (1.0, -1.0)])
    points = curve[at] + bight[:, :1] * away + apart * bight[:, 1:] * along
    points += rng.normal(0.0, 0.2, points.shape)
    extent = float(np.ptp(curve, axis=0).max()) + 10.0
    head, tail = (
        _leave(rng, points[a] - points[b], points[b], extent) for a, b in ((1, 0), (-2, -1))
    )
    return through(np.vstack([head[::-1], points, tail]), rng.uniform(0.4, 1.0))


# Curves of a cable that has to do with another one.
NEAR: tuple[Callable[[np.random.Generator, Points], Points], ...] = (touching, beside, hooked)

FAMILIES: dict[str, Callable[[np.random.Generator, float], Points]] = {
    "random": random_curve,
    "parallel": parallel_curve,
    "dense": dense_curve,
    "coil": coil_curve,
    "tight": tight_curve,
    "settled": settled_curve,
    "hairpin": hairpin_curve,
}
