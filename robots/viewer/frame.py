"""One moment of a scene, as viewers take it."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from robots.interfaces import Floats


@dataclass(frozen=True, slots=True, eq=False)
class CameraCone:
    """What an overhead camera sees.

    Attributes:
        position_m: The camera in the world [m], shape (3,).
        corners_m: Where the corners of its image meet the table, in order, shape (4, 3) [m].
    """

    position_m: Floats
    corners_m: Floats


@dataclass(frozen=True, slots=True, eq=False)
class SceneFrame:
    """Where everything that moves is at one moment, in the world frame.

    Attributes:
        time_s: On the cell's clock [s].
        link_poses: Pose of each link's URDF frame by the link's name, shape (7,): position [m],
            then quaternion xyzw. Links that are left out stay where they were.
        cable_m: Centre line of the cable in order, shape (N, 3), N >= 2 [m].
        cable_radius_m: Radius of the cable [m].
        trace_m: What perception last took for the cable, shape (M, 3), M >= 2 [m]; None before
            the first look.
        camera: The overhead camera; None before the first look.
        caption: One line on what goes on, e.g. the running node and its belief.
    """

    time_s: float
    link_poses: Mapping[str, Floats]
    cable_m: Floats
    cable_radius_m: float
    trace_m: Floats | None = None
    camera: CameraCone | None = None
    caption: str = ""


def thinned(points: Floats, count: int) -> Floats:
    """Return at most `count` of the points, first and last among them, evenly spread."""
    if len(points) <= count:
        return points
    return points[np.linspace(0, len(points) - 1, count).round().astype(int)]
