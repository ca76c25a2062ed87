"""Where traces cross themselves and each other, by geometry alone."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import Akima1DInterpolator

from perception.cable.polyline import arc_lengths, point_at
from perception.cable.topology.curve import Strand, StrandCrossing, intersections
from perception.cable.types import Crossing, Points, Trace

SPACING_PX = 3.0
# A line is bent between so many points at least, none of them much farther apart than usual.
FEWEST_BENT, MOST_UNEVEN = 3, 3.0
REACH_PX = 24.0
PATH_STEP_PX = 1.0
# Two centre lines that lie on each other cross many times by chance. Strands of a tight knot
# cross each other again nearly two widths on, and no sooner: they are as thick as that.
MERGE_WIDTHS = 1.4
# A strand cannot cross itself within this length of cable.
SHORTEST_LOOP_WIDTHS = 3.0


@dataclass(frozen=True, slots=True, eq=False)
class CrossingSite:
    """A place where two strands cross, before it is known which is on top.

    Attributes:
        position_px: Where, shape (2,).
        traces: Indices of the traces of strands a and b.
        arcs: Arc positions of both.
        directions: Unit tangents of both, shape (2, 2), one a row.
        turn: +1 where b runs counter-clockwise of a (as if y were up).
        paths: Both strands from `REACH_PX` before the crossing to as far behind it, every
            `PATH_STEP_PX`, shape (2, K, 2); beyond a trace's end its end is repeated.
    """

    position_px: Points
    traces: tuple[int, int]
    arcs: tuple[float, float]
    directions: Points
    turn: int
    paths: Points


def find_sites(traces: Sequence[Trace], width_px: float) -> tuple[CrossingSite, ...]:
    """Return all crossings of the traces in the order of the first, then the second, ...

    Args:
        traces: The traces.
        width_px: Width of the cables.
    """
    lines = [_line(trace) for trace in traces]
    sites = [
        site
        for i in range(len(lines))
        for j in range(i, len(lines))
        for site in _sites_between(lines, i, j, width_px)
    ]
    return tuple(sorted(sites, key=lambda site: (site.traces, site.arcs)))


@dataclass(frozen=True, slots=True, eq=False)
class _Line:
    """A trace in even steps, bent between its points, with arc lengths on the trace itself.

    A tracer's steps are two cable widths long, and cut the corners of a tight knot. Their own
    lengths would also place crossings beside where they are on the trace.
    """

    points: Points
    arcs: Points


def _line(trace: Trace) -> _Line:
    arcs = arc_lengths(trace.points_px)
    apart = np.append(True, np.diff(arcs) > 0.0)
    points, arcs = trace.points_px[apart], arcs[apart]
    steps = np.linspace(0.0, arcs[-1], max(round(arcs[-1] / SPACING_PX), 1) + 1)
    if len(points) < FEWEST_BENT or np.diff(arcs).max() > MOST_UNEVEN * np.median(np.diff(arcs)):
        return _Line(point_at(points, arcs, steps), steps)
    return _Line(Akima1DInterpolator(arcs, points, method="makima")(steps), steps)


def _sites_between(lines: list[_Line], i: int, j: int, width_px: float) -> list[CrossingSite]:
    one, other = lines[i], lines[j]
    a, b, turn = intersections(one.points, other.points)
    at_a = np.interp(a, np.arange(len(one.arcs)), one.arcs)
    at_b = np.interp(b, np.arange(len(other.arcs)), other.arcs)
    if i == j:
        once = at_b - at_a > SHORTEST_LOOP_WIDTHS * width_px
        at_a, at_b, turn = at_a[once], at_b[once], turn[once]
    return [
        CrossingSite(
            point_at(one.points, one.arcs, at_a[k]),
            (i, j),
            (float(at_a[k] / one.arcs[-1]), float(at_b[k] / other.arcs[-1])),
            np.stack(
                [
                    _tangent(one.points, one.arcs, at_a[k]),
                    _tangent(other.points, other.arcs, at_b[k]),
                ]
            ),
            int(turn[k]),
            np.stack(
                [_path(one.points, one.arcs, at_a[k]), _path(other.points, other.arcs, at_b[k])]
            ),
        )
        for k in _merge(at_a, at_b, turn, MERGE_WIDTHS * width_px)
    ]


def _path(line: Points, arcs: Points, at_px: float) -> Points:
    offsets = np.arange(-REACH_PX, REACH_PX + 0.5 * PATH_STEP_PX, PATH_STEP_PX)
    return point_at(line, arcs, at_px + offsets)


def _merge(
    at_a: Points, at_b: Points, turn: "np.ndarray[tuple[int], np.dtype[np.int64]]", near_px: float
) -> list[int]:
    """Return which crossings stay when those that lie on each other are merged.

    Lines that touch cross an even number of times with alternating turns, and none counts;
    lines that swap sides cross an odd number of times, and the middle one counts.
    """
    kept: list[int] = []
    left = list(np.argsort(at_a, kind="stable"))
    while left:
        group, left = [left[0]], left[1:]
        grown = True
        while grown:
            near = [
                k
                for k in left
                if any(
                    abs(at_a[k] - at_a[m]) < near_px and abs(at_b[k] - at_b[m]) < near_px
                    for m in group
                )
            ]
            group, left, grown = group + near, [k for k in left if k not in near], bool(near)
        net = int(sum(turn[k] for k in group))
        same = [k for k in group if turn[k] * net > 0]
        middle = len(same) // 2
        kept += [int(k) for k in same[middle : middle + 1]]
    return kept


def _tangent(line: Points, arcs: Points, at_px: float) -> Points:
    chord = point_at(line, arcs, at_px + 5.0) - point_at(line, arcs, at_px - 5.0)
    unit: Points = chord / max(float(np.linalg.norm(chord)), 1e-9)
    return unit


def decide(site: CrossingSite, probability_a_over: float) -> Crossing:
    """Return the crossing of a site, given the belief that strand a is on top."""
    over, under = (0, 1) if probability_a_over >= 0.5 else (1, 0)
    return Crossing(
        site.position_px,
        site.traces[over],
        site.arcs[over],
        site.traces[under],
        site.arcs[under],
        max(probability_a_over, 1.0 - probability_a_over),
    )


def strand_of(trace: Trace, index: int, crossings: Sequence[Crossing]) -> Strand:
    """Return one trace with its crossings with itself, as knot theory wants it.

    Args:
        trace: The trace.
        index: Its number in the crossings.
        crossings: Crossings of all traces.
    """
    # Knot theory's y points up; whether a knot is one does not depend on it, but all of a
    # diagram must agree.
    points = trace.points_px * np.array([1.0, -1.0])
    arcs = arc_lengths(points)
    found = []
    for crossing in crossings:
        if crossing.trace_over != index or crossing.trace_under != index:
            continue
        first_over = crossing.arc_over < crossing.arc_under
        at_px = np.sort([crossing.arc_over, crossing.arc_under]) * arcs[-1]
        a, b = (_tangent(points, arcs, at) for at in at_px)
        turn = 1 if a[0] * b[1] - a[1] * b[0] > 0.0 else -1
        first, second = np.interp(at_px, arcs, np.arange(len(arcs), dtype=float))
        found.append(StrandCrossing(float(first), float(second), turn, first_over))
    return Strand(points, tuple(sorted(found, key=lambda item: item.first)))
