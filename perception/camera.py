"""Pinhole cameras: what a frame is, and how pixels and points in the world go together.

Camera axes follow OpenCV: x right, y down, z along the view. Image points are (x, y) in
pixels with the centre of the top-left pixel at (0, 0).
"""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
GreyImage = NDArray[np.uint8]
DepthImage = NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class CameraModel:
    """Intrinsics and pose of a camera without lens distortion.

    Attributes:
        width_px: Image width.
        height_px: Image height.
        focal_px: Focal length, the same in x and y.
        centre_px: Principal point (x, y).
        T_world_camera: Maps camera coordinates to world coordinates, shape (4, 4).
    """

    width_px: int
    height_px: int
    focal_px: float
    centre_px: tuple[float, float]
    T_world_camera: Floats

    def project(self, points_world_m: Floats) -> Floats:
        """Return image points [px], shape (N, 2), of points in the world [m], shape (N, 3)."""
        rotation, origin_m = self.T_world_camera[:3, :3], self.T_world_camera[:3, 3]
        points_camera_m = (np.atleast_2d(points_world_m) - origin_m) @ rotation
        scaled = points_camera_m[:, :2] / points_camera_m[:, 2:3]
        return scaled * self.focal_px + np.asarray(self.centre_px)

    def on_plane(self, points_px: Floats, height_m: float = 0.0) -> Floats:
        """Return where rays of image points [px] meet the plane z = height, shape (N, 3) [m]."""
        offsets = (np.atleast_2d(points_px) - np.asarray(self.centre_px)) / self.focal_px
        rays = np.column_stack([offsets, np.ones(len(offsets))]) @ self.T_world_camera[:3, :3].T
        origin_m = self.T_world_camera[:3, 3]
        lengths = (height_m - origin_m[2]) / rays[:, 2:3]
        points: Floats = origin_m + lengths * rays
        return points


@dataclass(frozen=True, slots=True, eq=False)
class CameraFrame:
    """One look of a camera.

    Attributes:
        image: Grey values, shape (height, width), uint8.
        depth_m: Distance along the view [m], same shape, float32; NaN where unknown.
        stamp_s: When it was taken, on the cell's clock [s].
        camera: The camera that took it.
    """

    image: GreyImage
    depth_m: DepthImage
    stamp_s: float
    camera: CameraModel


@runtime_checkable
class Camera(Protocol):
    """A camera of a cell."""

    def capture(self) -> CameraFrame:
        """Take a frame now.

        Raises:
            DeviceError: The camera gives no frame.
        """
        ...
