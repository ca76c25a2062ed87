"""Cuboids seen through a pinhole camera: which pixels show them, and how deep.

Rays are clipped against the three pairs of planes of a cuboid (the slab test of Kay and Kajiya,
"Ray tracing complex scenes", 1986), for many cuboids at a time.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from perception.camera import CameraModel
from perception.shelf.slabs import cast_boxes
from perception.shelf.types import Floats

Ints = NDArray[np.int64]

# A ray along a plane would divide by nothing.
PARALLEL = 1e-12


@dataclass(frozen=True, slots=True, eq=False)
class Silhouettes:
    """The pixels of several boxes, box after box.

    Attributes:
        pixel: Index into the flattened image, shape (P,).
        depth_m: Distance of the box's surface along the view [m], shape (P,).
        box: Which box, ascending, shape (P,).
        count: Number of boxes; some may have no pixel.
    """

    pixel: Ints
    depth_m: Floats
    box: Ints
    count: int

    def sums(self, values: Floats) -> Floats:
        """Add up a value for each pixel, shape (P,), box by box, shape (count,)."""
        sums: Floats = np.bincount(self.box, weights=values, minlength=self.count).astype(float)
        return sums


class BoxCaster:
    """Casts the rays of one camera."""

    def __init__(self, camera: CameraModel) -> None:
        """Lay out the rays of all pixels."""
        self.camera = camera
        columns, rows = np.meshgrid(
            (np.arange(camera.width_px) - camera.centre_px[0]) / camera.focal_px,
            (np.arange(camera.height_px) - camera.centre_px[1]) / camera.focal_px,
        )
        axes = np.stack([columns, rows, np.ones_like(rows)], axis=-1)
        # The parameter of a ray is then the distance along the view.
        self.rays = axes @ camera.T_world_camera[:3, :3].T
        self.origin_m: Floats = camera.T_world_camera[:3, 3]
        steep = np.where(np.abs(self.rays) < PARALLEL, PARALLEL, self.rays)
        self._inverse = (1.0 / steep).reshape(-1, 3)

    def cast(self, low_m: Floats, high_m: Floats) -> Silhouettes:
        """Find the pixels of boxes that lie wholly in front of the camera.

        Args:
            low_m: Lower corners [m], world frame, shape (N, 3).
            high_m: Upper corners, same shape.

        Returns:
            Pixels inside the image only, box after box.
        """
        first, last = self._windows(low_m, high_m)
        limit = np.array([self.camera.height_px, self.camera.width_px]) - 1
        pixel, depth_m, box = cast_boxes(
            self._inverse,
            low_m - self.origin_m,
            high_m - self.origin_m,
            np.clip(first, 0, limit + 1),
            np.clip(last, -1, limit),
            self.camera.width_px,
        )
        return Silhouettes(pixel, depth_m, box, len(low_m))

    def inside(self, low_m: Floats, high_m: Floats) -> tuple[Floats, Floats]:
        """Return where every ray enters and leaves one box, shape (height, width) each.

        Where the ray misses it, it leaves before it enters.
        """
        shape = self.rays.shape[:2]
        near, far = _clip(self._inverse, low_m - self.origin_m, high_m - self.origin_m)
        return near.reshape(shape), far.reshape(shape)

    def _windows(self, low_m: Floats, high_m: Floats) -> tuple[Ints, Ints]:
        """Return each box's first and last (row, column), shape (N, 2)."""
        pick = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)], dtype=bool)
        points_m = np.where(pick, high_m[:, None, :], low_m[:, None, :])
        points_px = self.camera.project(points_m.reshape(-1, 3)).reshape(-1, 8, 2)[..., ::-1]
        first = np.floor(points_px.min(axis=1)).astype(np.int64)
        return first, np.ceil(points_px.max(axis=1)).astype(np.int64)


def _clip(inverse: Floats, low_m: Floats, high_m: Floats) -> tuple[Floats, Floats]:
    near = np.full(len(inverse), -np.inf)
    far = np.full(len(inverse), np.inf)
    for axis in range(3):
        a, b = low_m[..., axis] * inverse[:, axis], high_m[..., axis] * inverse[:, axis]
        near = np.maximum(near, np.minimum(a, b))
        far = np.minimum(far, np.maximum(a, b))
    return near, far
