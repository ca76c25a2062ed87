"""The camera that looks into the shelf from its front."""

import numpy as np

from perception.camera import CameraModel
from perception.shelf.types import Shelf


def front_camera(
    shelf: Shelf, width_px: int = 160, distance_m: float = 0.75, height_m: float = 0.2
) -> CameraModel:
    """Return a level camera before the middle of a shelf, 4:3, that just sees its whole width.

    The thesis names neither pose nor lens; its images have 640 x 480 pixels (section 7.5), and a
    width of 160 px is a quarter of that.

    Args:
        shelf: What to look into; its frame is the world.
        width_px: Image width.
        distance_m: From the front of the shelf.
        height_m: Above its floor.
    """
    height_px = 3 * width_px // 4
    T_world_camera = np.eye(4)
    T_world_camera[:3, :3] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]
    T_world_camera[:3, 3] = [0.5 * shelf.width_m, -distance_m, height_m]
    return CameraModel(
        width_px,
        height_px,
        0.97 * width_px * distance_m / shelf.width_m,
        (0.5 * (width_px - 1), 0.5 * (height_px - 1)),
        T_world_camera,
    )
