"""From curves to diagrams: where a curve crosses itself, and how an open one is closed.

An open cable is closed by a straight piece that passes over everything (thesis, section
2.2). Diagrams live on the sphere, so any other way over everything gives the same knot.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np
from numpy.typing import NDArray

from perception.cable.topology.diagram import Diagram

Floats = NDArray[np.float64]
Indices = NDArray[np.intp]
# Position on a closed curve, number of the crossing, and whether the strand is on top.
Visit = tuple[float, int, bool]

# Segments are looked at in blocks, for speed.
BLOCK = 8
TOUCHING = 1e-9
# Visits nearer than this to each other [segments] may come in the other order; so many pairs are
# tried, so many of them at once.
NEAR, MOST_NEAR, MOST_EXCHANGED = 0.25, 8, 3


@dataclass(frozen=True, slots=True)
class StrandCrossing:
    """A crossing of a curve with itself.

    Attributes:
        first: Position of the earlier visit, in segments from the start of the curve.
        second: Position of the later visit.
        turn: +1 where the later strand runs counter-clockwise (y up) of the earlier one.
        first_over: Whether the earlier strand is on top.
    """

    first: float
    second: float
    turn: int
    first_over: bool


@dataclass(frozen=True, slots=True, eq=False)
class Strand:
    """An open curve in the plane with its crossings.

    Attributes:
        points: Corners of the curve, shape (N, 2).
        crossings: Where it crosses itself.
    """

    points: Floats
    crossings: tuple[StrandCrossing, ...]


def intersections(a: Floats, b: Floats) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """Find where two polylines cross.

    Args:
        a: Corners of one, shape (N, 2).
        b: Corners of the other, shape (M, 2).

    Returns:
        Positions along `a`, along `b` (in segments from their starts), and the turn from
        `a` onto `b` (+1 counter-clockwise with y up), each of shape (K,).
    """
    i, j = _facing_segments(a, b)
    along_a, along_b = a[i + 1] - a[i], b[j + 1] - b[j]
    meet = _left(along_b, a[i] - b[j]) != _left(along_b, a[i + 1] - b[j])
    area = _cross(along_a, along_b)
    apart = np.flatnonzero(meet & (area != 0.0))
    apart = apart[np.lexsort((j[apart], i[apart]))]
    i, j, area, along_a, along_b = i[apart], j[apart], area[apart], along_a[apart], along_b[apart]
    offset = b[j] - a[i]
    u = np.clip(_cross(offset, along_b) / area, 0.0, 1.0)
    v = np.clip(_cross(offset, along_a) / area, 0.0, 1.0)
    return i + u, j + v, np.sign(area).astype(np.int64)


def _facing_segments(a: Floats, b: Floats) -> tuple[Indices, Indices]:
    """Return pairs of segments that may meet: ends of the second on both sides of the first.

    Only blocks whose boxes overlap are looked at.
    """
    low_a, high_a = _boxes(a)
    low_b, high_b = _boxes(b)
    overlap = (low_a[:, None] <= high_b[None]) & (low_b[None] <= high_a[:, None])
    first, second = np.nonzero(overlap.all(axis=2))
    corners_a, corners_b = _blocks(a)[first], _blocks(b)[second]
    along = np.diff(corners_a, axis=1)[:, :, None]
    left = _left(along, corners_b[:, None] - corners_a[:, :-1, None])
    pair, i, j = np.nonzero(left[:, :, 1:] != left[:, :, :-1])
    return first[pair] * BLOCK + i, second[pair] * BLOCK + j


def _blocks(points: Floats) -> Floats:
    """Return the corners of each block of segments, shape (blocks, BLOCK + 1, 2).

    The last block is filled with segments of no length, which meet nothing.
    """
    starts = np.arange(0, max(len(points) - 1, 1), BLOCK)
    return points[np.minimum(starts[:, None] + np.arange(BLOCK + 1), len(points) - 1)]


def _boxes(points: Floats) -> tuple[Floats, Floats]:
    """Return the least and greatest coordinates of each block of segments."""
    starts = np.arange(0, max(len(points) - 1, 1), BLOCK)
    # A block's last segment ends where the next one begins.
    ends = points[np.minimum(starts + BLOCK, len(points) - 1)]
    low = np.minimum(np.minimum.reduceat(points, starts), ends)
    high = np.maximum(np.maximum.reduceat(points, starts), ends)
    return low - TOUCHING, high + TOUCHING


def _left(along: Floats, offset: Floats) -> NDArray[np.bool_]:
    """Say which offsets from a segment's start lie to its left."""
    left: NDArray[np.bool_] = _cross(along, offset) >= 0.0
    return left


def _cross(a: Floats, b: Floats) -> Floats:
    product: Floats = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return product


def self_intersections(points: Floats) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """Return the crossings of a polyline with itself as `intersections` does, each once."""
    first, second, turn = intersections(points, points)
    # Neighbouring segments share a corner, which is no crossing.
    once = np.floor(second) > np.floor(first) + 1
    return first[once], second[once], turn[once]


def curve_crossings(nodes: Floats) -> Strand:
    """View a curve in space from above (+z).

    Args:
        nodes: Centre line, shape (N, 3).
    """
    points, heights = nodes[:, :2], nodes[:, 2]
    first, second, turn = self_intersections(points)
    index = np.arange(len(nodes), dtype=float)
    higher = np.interp(first, index, heights) > np.interp(second, index, heights)
    crossings = [
        StrandCrossing(float(a), float(b), int(t), bool(over))
        for a, b, t, over in zip(first, second, turn, higher, strict=True)
    ]
    return Strand(points, tuple(sorted(crossings, key=lambda crossing: crossing.first)))


def close_over(strand: Strand) -> Diagram:
    """Return the diagram of an open curve closed by a chord over everything.

    Crossings keep their numbers; those of the chord are numbered after them. Where crossings are
    so near to each other that their order along the curve is not known for certain, it is taken
    so that the diagram can be drawn in the plane.
    """
    visits: list[Visit] = []
    signs: list[int] = []
    for number, crossing in enumerate(strand.crossings):
        visits.append((crossing.first, number, crossing.first_over))
        visits.append((crossing.second, number, not crossing.first_over))
        signs.append(crossing.turn if crossing.first_over else -crossing.turn)
    last = len(strand.points) - 1
    chord = strand.points[[-1, 0]]
    on_chord, on_curve, turn = intersections(chord, strand.points)
    inside = (on_curve >= 1.0) & (on_curve <= last - 1.0)
    along = on_chord[inside] * _segments_long(chord, strand.points)
    for s, position, t in zip(along, on_curve[inside], turn[inside], strict=True):
        visits.append((last + 1.0 + float(s), len(signs), True))
        visits.append((float(position), len(signs), False))
        signs.append(int(t))
    visits.sort()
    diagram = _diagram(visits, signs)
    return diagram if diagram.is_planar() else _drawable(visits, signs) or diagram


def _segments_long(chord: Floats, points: Floats) -> float:
    """Return how many of a curve's segments a chord is long."""
    mean = float(np.linalg.norm(np.diff(points, axis=0), axis=1).mean())
    return float(np.linalg.norm(chord[1] - chord[0])) / max(mean, TOUCHING)


def _diagram(visits: Sequence[Visit], signs: Sequence[int]) -> Diagram:
    return Diagram(tuple(v[1] for v in visits), tuple(v[2] for v in visits), tuple(signs))


def _drawable(visits: Sequence[Visit], signs: Sequence[int]) -> Diagram | None:
    """Return a planar diagram with a few near visits exchanged; None where there is none.

    Of crossings that were found on a smoothed curve, or are left of several that lay on each
    other, the order is not sure.
    """
    gaps = sorted(
        (after[0] - before[0], k)
        for k, (before, after) in enumerate(pairwise(visits))
        if before[1] != after[1]
    )
    near = [k for gap, k in gaps if gap < NEAR][:MOST_NEAR]
    for count in range(1, MOST_EXCHANGED + 1):
        for chosen in combinations(near, count):
            order = list(visits)
            for k in chosen:
                order[k], order[k + 1] = order[k + 1], order[k]
            diagram = _diagram(order, signs)
            if diagram.is_planar():
                return diagram
    return None
