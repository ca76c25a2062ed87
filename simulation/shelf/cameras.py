"""The camera that looks into the shelf from its front."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

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


def viewpoint_cameras(
    shelf: Shelf, middle: CameraModel, aside_share: float = 0.25
) -> dict[str, CameraModel]:
    """Return the cameras of a shelf cell by viewpoint: in the middle, and aside, turned inwards.

    Args:
        shelf: The shelf.
        middle: The camera before its middle.
        aside_share: How far the others are from it, as a share of the shelf's width.
    """
    cameras = {"centre": middle}
    distance_m = 0.5 * shelf.depth_m - float(middle.T_world_camera[1, 3])
    for name, sign in (("left", -1.0), ("right", 1.0)):
        aside_m = sign * aside_share * shelf.width_m
        angle_rad = np.arctan2(aside_m, distance_m)
        turn = np.eye(4)
        cosine, sine = np.cos(angle_rad), np.sin(angle_rad)
        turn[:2, :2] = [[cosine, -sine], [sine, cosine]]
        T_world_camera = middle.T_world_camera.copy()
        T_world_camera[:3, :3] = turn[:3, :3] @ T_world_camera[:3, :3]
        T_world_camera[0, 3] += aside_m
        cameras[name] = CameraModel(
            middle.width_px, middle.height_px, middle.focal_px, middle.centre_px, T_world_camera
        )
    return cameras


def sees_floor(
    cameras: Iterable[CameraModel], x_m: NDArray[np.float64], y_m: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Say which places on the floor of an empty shelf any of the cameras sees, shape (h, w).

    Args:
        cameras: Before the shelf.
        x_m: Columns, along the shelf, shape (w,).
        y_m: Rows, into it, shape (h,).
    """
    x, y = np.meshgrid(x_m, y_m)
    places_m = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    seen = np.zeros(x.size, dtype=bool)
    for camera in cameras:
        points_px = camera.project(places_m)
        size_px = np.array([camera.width_px, camera.height_px])
        seen |= ((points_px >= -0.5) & (points_px <= size_px - 0.5)).all(axis=1)
    return seen.reshape(x.shape)
