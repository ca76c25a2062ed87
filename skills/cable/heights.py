"""How high things lie above the table, by the depth image."""

import numpy as np

from perception.cable.types import Points
from perception.camera import CameraFrame
from robots.interfaces import Floats

# The axis of an ordinary cable lies so far below what the camera sees of it.
CABLE_RADIUS_M = 0.0033
# The depth of a place is the median of so many pixels to each side of it.
PATCH_PX = 2


def heights_m(frame: CameraFrame, points_px: Floats) -> Floats:
    """Return heights above the table of image points, 0 where the depth is unknown.

    Args:
        frame: Overhead frame.
        points_px: Image points (x, y), shape (N, 2).
    """
    if not len(points_px):
        return np.zeros(0)
    columns, rows = np.rint(points_px).astype(int).T
    pose = frame.camera.T_world_camera
    table_m = (frame.camera.on_plane(points_px) - pose[:3, 3]) @ pose[:3, 2]
    heights: Floats = np.nan_to_num(table_m - frame.depth_m[rows, columns], nan=0.0)
    return heights


def axis_height_m(frame: CameraFrame, point_px: Points) -> float:
    """Return how high the axis of the cable lies at a point of its centre line.

    Args:
        frame: Overhead frame.
        point_px: Image point (x, y), shape (2,).

    Returns:
        At least the height of a cable that lies on the table, which is also said where the
        depth is unknown.
    """
    offsets = np.arange(-PATCH_PX, PATCH_PX + 1)
    grid = np.stack(np.meshgrid(offsets, offsets), axis=-1).reshape(-1, 2)
    size_px = np.array([frame.camera.width_px, frame.camera.height_px])
    patch = np.clip(np.rint(point_px) + grid, 0, size_px - 1)
    within = patch[np.linalg.norm(grid, axis=1) <= PATCH_PX]
    seen_m = float(np.median(heights_m(frame, within)))
    return max(seen_m - CABLE_RADIUS_M, CABLE_RADIUS_M)
