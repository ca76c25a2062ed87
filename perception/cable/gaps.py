"""Gaps in the mask where a lower strand lies in the shadow of an upper one.

A dead end that points at another strand close by is a strand that goes on below it: the
mask is continued up to there. Ends with a connector are left alone.
"""

from dataclasses import dataclass, replace

import cv2
import numpy as np

from perception.cable.graph import SkeletonGraph, usual_radius
from perception.cable.mask import CableMask, radii
from perception.cable.polyline import arc_lengths
from perception.cable.types import Points


@dataclass(frozen=True, slots=True)
class GapConfig:
    """Settings of gaps; lengths in cable widths.

    Attributes:
        widest_widths: Widest gap.
        direction_widths: Length of cable that gives the direction.
        connector_ratio: A dead end this much wider than the cable is a connector.
    """

    widest_widths: float = 1.6
    direction_widths: float = 2.5
    connector_ratio: float = 1.3


def close_gaps(
    mask: CableMask, graph: SkeletonGraph, config: GapConfig | None = None
) -> CableMask | None:
    """Return the mask with gaps closed; None where there are none."""
    config = config or GapConfig()
    radius_px = usual_radius(graph)
    canvas, thickness = mask.cable.astype(np.uint8), max(round(0.6 * mask.width_px), 1)
    closed = 0
    for arms in graph.arms:
        if len(arms) != 1:
            continue
        edge, end = graph.edges[arms[0][0]], arms[0][1]
        points = edge.from_end(end)
        radius_along = edge.radius_px if end == 0 else edge.radius_px[::-1]
        near = arc_lengths(points) <= config.direction_widths * mask.width_px
        if radius_along[near].max() > config.connector_ratio * radius_px:
            continue
        far = _far_side(mask, points[near], config.widest_widths * mask.width_px)
        if far is not None:
            begin, stop = ((round(float(x)), round(float(y))) for x, y in (points[0], far))
            cv2.line(canvas, begin, stop, 1, thickness)
            closed += 1
    if not closed:
        return None
    cable = canvas.astype(bool)
    return replace(mask, cable=cable, radius_px=radii(cable))


def _far_side(mask: CableMask, last: Points, widest_px: float) -> Points | None:
    """Return a point within the strand on the far side of a gap; None without one.

    Args:
        mask: The mask.
        last: The last points of the centre line, the dead end first.
        widest_px: Widest gap.
    """
    chord = last[0] - last[-1]
    ahead = chord / max(float(np.linalg.norm(chord)), 1e-9)
    steps = np.arange(0.0, widest_px + 2.0 * mask.width_px, 0.5)
    places = last[0] + steps[:, None] * ahead
    x, y = np.rint(places).astype(int).T
    height, width = mask.cable.shape
    inside = (x >= 0) & (y >= 0) & (x < width) & (y < height)
    on_cable = np.zeros(len(steps), dtype=bool)
    on_cable[inside] = mask.cable[y[inside], x[inside]]
    leaves = int(np.argmin(on_cable))
    again = np.flatnonzero(on_cable[leaves:])
    if not len(again) or steps[again[0] + leaves] - steps[leaves] > widest_px:
        return None
    return last[0] + (steps[again[0] + leaves] + 0.5 * mask.width_px) * ahead
