"""Where a gripper can take hold of a traced cable around a knot.

The thesis (section 3.4) looks for the pinch point on the strand that leaves the knot on top,
between the undercrossing before and the one after it, and for the cage point on the strand
that enters below, up to its next undercrossing. Two hands need room, so each region gives
all its sites, with the room around each, and the robot picks the pair that it can reach.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from perception.cable.polyline import arc_lengths, point_at
from perception.cable.types import Crossing, Knot, Points, Trace

STRIDE_PX = 16.0
# A finger stands beside the cable by half the opening and is about 12 mm thick.
SIDE_ROOM_PX = 40.0
ALONG_ROOM_PX = 10.0
# Cable nearer than this along the trace is the same piece, not a neighbour.
OWN_PIECE_PX = 45.0


@dataclass(frozen=True, slots=True, eq=False)
class GraspSite:
    """One place to hold a cable.

    Attributes:
        point_px: On the centre line, shape (2,).
        direction: Unit tangent there, shape (2,).
        arc: Arc position on the trace.
        room_px: Distance to the nearest other strand where the fingers go, at most
            `SIDE_ROOM_PX`.
    """

    point_px: Points
    direction: Points
    arc: float
    room_px: float


def pinch_sites(trace: Trace, crossings: Sequence[Crossing], knot: Knot) -> tuple[GraspSite, ...]:
    """Return sites on the upper strand that closes the knot, in the order of the trace."""
    unders = _under_arcs(crossings, knot.trace)
    begin = max(
        (arc for arc in unders if knot.interval[0] < arc < knot.interval[1]),
        default=knot.interval[0],
    )
    end = min((arc for arc in unders if arc > knot.interval[1]), default=1.0)
    return sites_between(trace, begin, end)


def cage_sites(trace: Trace, crossings: Sequence[Crossing], knot: Knot) -> tuple[GraspSite, ...]:
    """Return sites on the lower strand that opens the knot, in the order of the trace."""
    unders = _under_arcs(crossings, knot.trace)
    end = min(
        (arc for arc in unders if knot.interval[0] < arc < knot.interval[1]),
        default=knot.interval[1],
    )
    return sites_between(trace, knot.interval[0], end)


def sites_between(trace: Trace, begin: float, end: float) -> tuple[GraspSite, ...]:
    """Return sites every `STRIDE_PX` between two arc positions, both ends left out."""
    path = trace.points_px
    arcs_px = arc_lengths(path)
    length_px = float(arcs_px[-1])
    wanted_px = np.arange(begin * length_px + STRIDE_PX, end * length_px, STRIDE_PX)
    return tuple(_site(path, arcs_px, at_px) for at_px in wanted_px)


def _under_arcs(crossings: Sequence[Crossing], trace: int) -> list[float]:
    return [crossing.arc_under for crossing in crossings if crossing.trace_under == trace]


def _site(path: Points, arcs_px: Points, at_px: float) -> GraspSite:
    point_px = point_at(path, arcs_px, at_px)
    chord = point_at(path, arcs_px, at_px + 8.0) - point_at(path, arcs_px, at_px - 8.0)
    direction = chord / max(float(np.linalg.norm(chord)), 1e-9)
    others = path[np.abs(arcs_px - at_px) > OWN_PIECE_PX] - point_px
    along_px = np.abs(others @ direction)
    aside_px = np.abs(others @ np.array([-direction[1], direction[0]]))
    near = aside_px[along_px < ALONG_ROOM_PX]
    room_px = min(SIDE_ROOM_PX, float(near.min(initial=SIDE_ROOM_PX)))
    return GraspSite(point_px, direction, at_px / float(arcs_px[-1]), room_px)
