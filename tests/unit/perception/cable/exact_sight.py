"""Drawn cables as they would be seen without any error."""

import cv2
import numpy as np
from synthetic_cable import Drawing

from perception.cable.grasp_points import CablePixels
from perception.cable.polyline import arc_lengths
from perception.cable.topology import curve_crossings
from perception.cable.types import Crossing, Trace, TraceEnd


def seen_exactly(
    drawing: Drawing, scale: float = 1.0, width_px: float = 6.0
) -> tuple[Trace, tuple[Crossing, ...], CablePixels]:
    """Return the trace of a drawing at a scale, its crossings, and what is cable."""
    points = drawing.points_px * scale
    arcs = arc_lengths(points) / arc_lengths(points)[-1]
    index = np.arange(len(points), dtype=float)
    crossings = []
    for c in curve_crossings(drawing.nodes * (1.0, -1.0, 1.0)).crossings:
        first, second = np.interp([c.first, c.second], index, arcs)
        over, under = (first, second) if c.first_over else (second, first)
        where = np.array([np.interp(c.first, index, axis) for axis in points.T])
        crossings.append(Crossing(where, 0, float(over), 0, float(under), 1.0))
    canvas = np.zeros((round(900 * scale), round(1200 * scale)), np.uint8)
    corners = np.round(points * 16.0).astype(np.int32)
    cv2.polylines(canvas, [corners], False, 1, round(width_px), cv2.LINE_8, 4)
    trace = Trace(points, TraceEnd.ENDPOINT, 1.0)
    return trace, tuple(crossings), CablePixels(canvas > 0, width_px)
