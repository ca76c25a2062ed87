"""Looks into a shelf as the spatial network sees them: 128 x 40 pixels, whatever the camera."""

import numpy as np
from numpy.typing import NDArray

from perception.camera import CameraModel, DepthImage
from perception.shelf.types import Floats, Shelf, Size

Maps = NDArray[np.float32]

COLUMNS, ROWS = 128, 40
# Depth behind the shelf's edge, whether it is known, three sizes of the target, two places.
CHANNELS = 7
# What sizes and depths are divided by [m].
LONG_M = 0.3


def window_camera(camera: CameraModel, shelf: Shelf) -> CameraModel:
    """Return a camera in the same place whose image is what the network sees.

    It just covers the width of the shelf's open front, from the floor up.

    Args:
        camera: A level camera that looks along y; its frame is the shelf's.
        shelf: What it looks into.
    """
    x_m, y_m, z_m = camera.T_world_camera[:3, 3].tolist()
    focal_px = COLUMNS * -y_m / shelf.width_m
    scale = focal_px / -y_m
    centre_px = (scale * x_m - 0.5, ROWS - 0.5 - scale * z_m)
    return CameraModel(COLUMNS, ROWS, focal_px, centre_px, camera.T_world_camera)


def seen_through(depth_m: DepthImage | Floats, camera: CameraModel, window: CameraModel) -> Floats:
    """Return depth of the window's pixels [m], shape (ROWS, COLUMNS); NaN beside the image."""
    rows, columns = (_places(window, camera, axis) for axis in (0, 1))
    size = np.array(depth_m.shape)
    inside = ((rows >= 0) & (rows < size[0]))[:, None] & ((columns >= 0) & (columns < size[1]))
    found = depth_m[np.clip(rows, 0, size[0] - 1)][:, np.clip(columns, 0, size[1] - 1)]
    return np.where(inside, found, np.nan).astype(np.float64)


def spread(heat: Maps, camera: CameraModel, window: CameraModel) -> Floats:
    """Return what the window shows in the camera's own image, 0 beside it, (height, width)."""
    rows, columns = (_places(camera, window, axis) for axis in (0, 1))
    inside = ((rows >= 0) & (rows < ROWS))[:, None] & ((columns >= 0) & (columns < COLUMNS))
    found = heat[np.clip(rows, 0, ROWS - 1)][:, np.clip(columns, 0, COLUMNS - 1)]
    return np.where(inside, found, 0.0).astype(np.float64)


def prepare(depth_m: Floats, window: CameraModel, shelf: Shelf, target_m: Size) -> Maps:
    """Return the network's input, shape (CHANNELS, ROWS, COLUMNS).

    Args:
        depth_m: Depth of the window's pixels, NaN where unknown, shape (ROWS, COLUMNS).
        window: From `window_camera`.
        shelf: What is looked into.
        target_m: Size of the target.
    """
    behind = (depth_m + window.T_world_camera[1, 3]) / LONG_M
    known = np.isfinite(behind)
    maps = np.empty((CHANNELS, ROWS, COLUMNS), np.float32)
    maps[0] = np.clip(np.where(known, behind, 0.0), -0.5, 2.0)
    maps[1] = known
    maps[2:5] = (np.array(target_m) / LONG_M)[:, None, None]
    maps[5] = shelf.width_m * np.linspace(-0.5, 0.5, COLUMNS) / LONG_M
    maps[6] = (shelf.width_m / COLUMNS * (ROWS - 0.5 - np.arange(ROWS)) / LONG_M)[:, None]
    return maps


def _places(one: CameraModel, other: CameraModel, axis: int) -> NDArray[np.int64]:
    """Return which row (axis 0) or column (1) of the other camera each of one's falls on."""
    count = (one.height_px, one.width_px)[axis]
    offsets = (np.arange(count) - one.centre_px[1 - axis]) / one.focal_px
    return np.rint(other.centre_px[1 - axis] + other.focal_px * offsets).astype(np.int64)
