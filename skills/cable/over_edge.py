"""Cable that hangs over the edge of the table looks as if it ended there."""

from dataclasses import replace

import numpy as np

from perception.cable.orientation import reversed_trace
from perception.cable.types import Points, Trace, TraceEnd
from perception.camera import CameraFrame
from robots.placement import TABLE_SIZE_M

# What comes to within so much of the edge leaves the table, or is pulled in to make sure.
NEAR_EDGE_M = 0.035


def leaving(trace: Trace, frame: CameraFrame) -> Trace:
    """Return a trace that says so where it leaves the table instead of coming to an end.

    Args:
        trace: A trace; where it leaves at its start it is turned round.
        frame: The frame that it was traced in.
    """
    if trace.end is not TraceEnd.ENDPOINT:
        return trace
    starts, ends = (at_edge(trace.points_px[k], frame) for k in (0, -1))
    turned = reversed_trace(trace) if starts and not ends else trace
    return replace(turned, end=TraceEnd.EDGE) if starts or ends else trace


def at_edge(point_px: Points, frame: CameraFrame) -> bool:
    """Return whether an image point lies at the edge of the table, or beyond it."""
    place_m = np.abs(frame.camera.on_plane(point_px)[0][:2])
    return bool((place_m > np.array(TABLE_SIZE_M) / 2.0 - NEAR_EDGE_M).any())
