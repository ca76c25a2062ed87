"""What a trace does not show of a cable: it stops where connectors begin."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from perception.cable.covered_ends import CONNECTOR_PX
from perception.cable.polyline import arc_lengths, point_at
from perception.cable.topology.curve import intersections
from perception.cable.types import Crossing, Endpoint, Points, Trace, TraceEnd

# So many points before its end give the direction in which a trace would go on.
LEAD_POINTS = 5
STEP_PX = 4.0
# An end that was detected this near to the end of a trace is the same.
SAME_END_PX = 12.0
# A piece of a trace no longer than this leads to a connector, and does not cross it.
LEAD_PX = 15.0
# Nobody has looked at who is on top there.
NOTHING_KNOWN = 0.5


def with_connectors(trace: Trace, endpoints: Sequence[Endpoint] = ()) -> Trace:
    """Return a trace that goes on along the connectors: it stops where they begin.

    Args:
        trace: From end to end, else it is returned as it is.
        endpoints: Ends with their directions; those of the trace where they are not among them.
    """
    if trace.end is not TraceEnd.ENDPOINT or len(trace.points_px) < 2:
        return trace
    first, last = (_beyond(line, endpoints) for line in (trace.points_px[::-1], trace.points_px))
    return replace(trace, points_px=np.vstack([first[::-1], trace.points_px, last]))


def _beyond(line: Points, endpoints: Sequence[Endpoint]) -> Points:
    """Return points along a connector at the end of a line, shape (K, 2)."""
    back = line[-min(len(line), LEAD_POINTS)]
    outwards = (line[-1] - back) / max(float(np.linalg.norm(line[-1] - back)), 1e-9)
    for end in endpoints:
        if np.linalg.norm(end.position_px - line[-1]) <= SAME_END_PX:
            outwards = -end.direction
    along_px = np.arange(STEP_PX, CONNECTOR_PX + STEP_PX, STEP_PX)
    points: Points = line[-1] + along_px[:, None] * outwards
    return points


def through_connectors(
    trace: Trace, crossings: Sequence[Crossing], endpoints: Sequence[Endpoint]
) -> tuple[Trace, tuple[Crossing, ...]]:
    """Return a trace that goes on along its connectors, where a strand lies across one of them.

    Whether an end lies under a strand can make a knot of a cable that shows none. Crossings of
    connectors are added, of which nothing is believed.

    Args:
        trace: The only trace.
        crossings: Its crossings.
        endpoints: Ends that were seen.
    """
    whole = with_connectors(trace, endpoints)
    hidden = _hidden(trace, whole)
    if not hidden:
        return trace, tuple(crossings)
    arcs_px = arc_lengths(whole.points_px)
    first = (len(whole.points_px) - len(trace.points_px)) // 2
    length_px = float(arc_lengths(trace.points_px)[-1])

    def moved(arc: float) -> float:
        return float((arcs_px[first] + arc * length_px) / arcs_px[-1])

    known = (
        replace(c, arc_over=moved(c.arc_over), arc_under=moved(c.arc_under)) for c in crossings
    )
    places = point_at(whole.points_px, arcs_px, np.array([first for first, _ in hidden]))
    added = (
        Crossing(place, 0, first / arcs_px[-1], 0, second / arcs_px[-1], NOTHING_KNOWN)
        for place, (first, second) in zip(places, hidden, strict=True)
    )
    return whole, (*known, *added)


def _hidden(trace: Trace, whole: Trace) -> list[tuple[float, float]]:
    """Return arc lengths [px] at which connectors cross a trace, the smaller of each pair first."""
    line = whole.points_px
    beyond = (len(line) - len(trace.points_px)) // 2
    arcs_px, rows = arc_lengths(line), np.arange(len(line), dtype=float)
    found = set[tuple[float, float]]()
    for first, last in ((0, beyond), (len(line) - 1 - beyond, len(line) - 1)) if beyond else ():
        along, across, _ = intersections(line[first : last + 1], line)
        pairs_px = np.interp(np.column_stack([first + along, across]), rows, arcs_px)
        far = np.abs(pairs_px[:, 0] - pairs_px[:, 1]) > CONNECTOR_PX + LEAD_PX
        found |= {(a, b) for a, b in np.sort(pairs_px[far], axis=1).round(6).tolist()}
    return sorted(found)
