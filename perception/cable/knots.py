"""Knots of traced cables, and where to hold them.

The thesis's rule names places that look like knots; only those whose piece of cable, closed
over everything, is proved to be knotted are kept. Where the rule names none although the
whole cable is knotted, the shortest knotted piece is searched for instead.
"""

from collections.abc import Sequence

import numpy as np

from perception.cable.crossings import strand_of
from perception.cable.grasp_points import GraspConfig, choose_grasps
from perception.cable.topology import (
    Knottedness,
    Strand,
    StrandCrossing,
    classify_diagram,
    close_over,
)
from perception.cable.topology.rule import Visit, knot_intervals
from perception.cable.tracers.centre_line import arc_lengths, point_at
from perception.cable.types import Crossing, Knot, Points, Trace


def find_knots(
    traces: Sequence[Trace], crossings: Sequence[Crossing], config: GraspConfig | None = None
) -> tuple[Knot, ...]:
    """Return the knots of all traces in the order of the traces."""
    config = config or GraspConfig()
    return tuple(
        knot
        for index, trace in enumerate(traces)
        for knot in _knots_of(trace, index, traces, crossings, config)
    )


def _knots_of(
    trace: Trace,
    index: int,
    traces: Sequence[Trace],
    crossings: Sequence[Crossing],
    config: GraspConfig,
) -> list[Knot]:
    own = [c for c in crossings if c.trace_over == index and c.trace_under == index]
    if not _is_knotted(trace, index, own, 0.0, 1.0):
        return []
    visits = visits_of(own)
    named = [(a.arc, b.arc) for a, b in knot_intervals(visits)]
    intervals = [span for span in named if _is_knotted(trace, index, own, *span)]
    if not intervals:
        intervals = [_shortest_knotted(trace, index, own, visits)]
    return [choose_grasps(traces, index, crossings, span, config) for span in intervals]


def visits_of(crossings: Sequence[Crossing]) -> list[Visit]:
    """Return the visits of one trace's crossings with itself, in the order of the trace."""
    visits = [
        Visit(number, over, arc)
        for number, crossing in enumerate(crossings)
        for over, arc in ((True, crossing.arc_over), (False, crossing.arc_under))
    ]
    return sorted(visits, key=lambda visit: visit.arc)


def _is_knotted(
    trace: Trace, index: int, crossings: Sequence[Crossing], begin: float, end: float
) -> bool:
    """Say whether the piece between two arc positions is knotted when closed over everything.

    Both arc positions count as part of the piece.
    """
    strand = piece(strand_of(trace, index, crossings), begin, end)
    return classify_diagram(close_over(strand)).state is Knottedness.KNOTTED


def piece(strand: Strand, begin: float, end: float) -> Strand:
    """Return the part of a strand between two arc positions, a little beyond both."""
    arcs = arc_lengths(strand.points)
    margin_px = 4.0
    low = max(begin * arcs[-1] - margin_px, 0.0)
    high = min(end * arcs[-1] + margin_px, arcs[-1])
    inside = (arcs > low) & (arcs < high)
    ends = point_at(strand.points, arcs, np.array([low, high]))
    points: Points = np.concatenate([ends[:1], strand.points[inside], ends[1:]])
    shift = int(np.argmax(inside)) - 1
    index = np.arange(len(arcs), dtype=float)
    first, last = np.interp([low, high], arcs, index)
    kept = tuple(
        StrandCrossing(c.first - shift, c.second - shift, c.turn, c.first_over)
        for c in strand.crossings
        if first <= c.first and c.second <= last
    )
    return Strand(points, kept)


def _shortest_knotted(
    trace: Trace, index: int, crossings: Sequence[Crossing], visits: Sequence[Visit]
) -> tuple[float, float]:
    """Return the piece that is left when visits are dropped from both ends while knotted."""
    arcs = [visit.arc for visit in visits]
    begin, end = 0, len(arcs) - 1
    while begin < end and _is_knotted(trace, index, crossings, arcs[begin + 1], arcs[end]):
        begin += 1
    while begin < end and _is_knotted(trace, index, crossings, arcs[begin], arcs[end - 1]):
        end -= 1
    return arcs[begin], arcs[end]
