"""First paths of a search: one, or one for each direction where none is known."""

from collections.abc import Sequence

import numpy as np

from perception.cable.polyline import arc_lengths, point_at
from perception.cable.tracers.paths import Path
from perception.cable.types import Endpoint, Points
from perception.models.frames import ScaledImage
from perception.models.tracer_crop import STEP

DIRECTIONS = 16
# A path that has a point this near to its start goes through it.
SAME = 0.25 * STEP


def first_paths(start_px: Points, endpoints: Sequence[Endpoint], scaled: ScaledImage) -> list[Path]:
    """Return paths before any choice.

    Args:
        start_px: First points of the cable in the original image, in order, shape (N, 2).
        endpoints: Ends of cables; one at a single first point tells its direction.
        scaled: The image that paths lie in.
    """
    points = scaled.into(start_px)
    if len(points) > 1:
        return [_fresh(stepwise(points))]
    known = [
        end.direction
        for end in endpoints
        if np.linalg.norm(scaled.into(end.position_px) - points[0]) < STEP
    ]
    turns = np.linspace(0.0, 2.0 * np.pi, DIRECTIONS, endpoint=False)
    ways = known[:1] or list(np.column_stack([np.cos(turns), np.sin(turns)]))
    return [_fresh(np.vstack([points[0] - STEP * way, points[0]])) for way in ways]


def from_start(start: Points, points: Points) -> Points:
    """Return a path from its start on, without a point behind it that told its direction.

    Args:
        start: Where the cable begins, shape (2,).
        points: Of the path, shape (N, 2).
    """
    gaps = np.linalg.norm(points[:2] - start, axis=1)
    nearest = int(gaps.argmin())
    ahead = points[nearest + 1 :] if gaps[nearest] < SAME else points
    # A path that never left its start keeps the point that tells its direction.
    return np.vstack([start, ahead]) if len(ahead) else points


def _fresh(points: Points) -> Path:
    return Path(points, np.zeros(len(points)))


def stepwise(points: Points) -> Points:
    """Return points one step apart that end at the last one; two at least."""
    along = arc_lengths(points)
    arcs = along[-1] - STEP * np.arange(int(along[-1] / STEP) + 1)
    if len(arcs) < 2:
        arcs = along[[-1, 0]]
    return point_at(points, along, arcs[::-1])
