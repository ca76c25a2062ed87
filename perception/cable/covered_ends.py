"""Ends whose connector is crossed: a trace stops where a connector begins, the cable does not."""

import numpy as np

from perception.cable.polyline import arc_lengths
from perception.cable.types import Endpoint, Points, Trace

# From where the cable's own width ends to the tip of a connector.
CONNECTOR_PX = 40.0
# A strand whose centre line comes nearer than this to a connector's axis lies across it.
ACROSS_PX = 7.0
# The piece that leads to an end gives its direction, and does not cross it.
LEAD_PX = 15.0


def connector_px(end: Endpoint) -> Points:
    """Return points along the axis of a connector, from the cable to its tip, shape (N, 2)."""
    return _axis(end.position_px, -end.direction)


def crossed_ends(trace: Trace, endpoints: tuple[Endpoint, ...]) -> tuple[bool, ...]:
    """Say of each end whether a strand of a trace lies across its connector."""
    line = trace.points_px
    arcs = arc_lengths(line)
    # Whichever end of the trace is nearer leads to the connector, and does not cross it.
    starts = [bool(np.argmin(_gaps(line[[0, -1]], end.position_px)) == 0) for end in endpoints]
    return tuple(
        _is_crossed(line, arcs if first else arcs[-1] - arcs, connector_px(end))
        for end, first in zip(endpoints, starts, strict=True)
    )


def ends_are_clear(path_px: Points) -> bool:
    """Return whether no strand of a path lies across a connector at one of its ends.

    Such a crossing is one of the cable's, and does not show in the trace.

    Args:
        path_px: Centre line from end to end, shape (N, 2).
    """
    arcs = arc_lengths(path_px)
    if arcs[-1] <= 2.0 * (CONNECTOR_PX + LEAD_PX):
        return True
    return _leads_clear(path_px, arcs) and _leads_clear(path_px[::-1], arcs[-1] - arcs[::-1])


def _leads_clear(line: Points, arcs: Points) -> bool:
    """Look at the end that a line begins with; `arcs` is how far each point is from there."""
    lead = line[int(np.searchsorted(arcs, LEAD_PX))]
    outwards = (line[0] - lead) / np.linalg.norm(line[0] - lead)
    return not _is_crossed(line, arcs, _axis(line[0], outwards))


def _is_crossed(line: Points, arcs: Points, axis: Points) -> bool:
    others = line[arcs > CONNECTOR_PX + LEAD_PX]
    return any(float(_gaps(others, point).min(initial=np.inf)) <= ACROSS_PX for point in axis)


def _axis(start_px: Points, outwards: Points) -> Points:
    axis: Points = start_px + np.arange(0.0, CONNECTOR_PX, 2.0)[:, None] * outwards
    return axis


def _gaps(points: Points, point: Points) -> Points:
    gaps: Points = np.linalg.norm(points - point, axis=1)
    return gaps
