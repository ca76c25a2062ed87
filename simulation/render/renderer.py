"""From shapes to brightness and depth as one camera sees them."""

from dataclasses import dataclass

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from perception.camera import CameraModel
from simulation.render.backdrop import make_backdrop
from simulation.render.primitives import Material, Primitives
from simulation.render.raycast import View, cast
from simulation.render.shading import AMBIENT, Image, Lamp, Rays, plane_light, plane_shadow, shade

Floats = NDArray[np.float64]

SUPERSAMPLING = 2  # rays a pixel in x and in y
LAMP_POSITION_M = (-0.35, -0.02, 1.15)
_SHADOW_TEXEL_M = 0.0008  # on the table's surface
_SHADOW_MARGIN_M = 0.06  # around the table
_LAMP_GRAIN = 2  # see `raycast.cast`
_PENUMBRA_PX = 1.4  # the lamp is no point; its shadows have soft edges

# Share by which a surface flickers under the projector's coherent light.
_CLOTH_SPECKLE = 0.060
_FLOOR_SPECKLE = 0.010
_SPECKLE = np.zeros(len(Material), np.float32)
_SPECKLE[Material.PAINT] = 0.010
_SPECKLE[Material.BRAID] = 0.050
_SPECKLE[Material.PLASTIC] = 0.035
_SPECKLE[Material.METAL] = 0.020


@dataclass(frozen=True, slots=True, eq=False)
class Rendering:
    """What a perfect sensor would measure.

    Attributes:
        brightness: Shape (height, width); 1.0 is white.
        speckle: Share by which a surface flickers under the lamp, same shape.
        depth_m: Distance along the view, same shape; NaN where the lamp does not reach.
    """

    brightness: Image
    speckle: Image
    depth_m: Image


class Renderer:
    """Draws shapes over an empty table."""

    def __init__(
        self, camera: CameraModel, table_size_m: tuple[float, float], rng: np.random.Generator
    ) -> None:
        """Lay the cloth; the same generator state gives the same cloth."""
        self._backdrop = make_backdrop(camera, table_size_m, rng)
        self._view = _view(camera, 1)
        self._fine_view = _view(camera, SUPERSAMPLING)
        fine = (camera.height_px * SUPERSAMPLING, camera.width_px * SUPERSAMPLING)
        self._rays = _no_rays(fine)
        lamp_view, size = _lamp_view(table_size_m)
        self._lamp_rays = _no_rays(size)
        self._lamp = Lamp(lamp_view, self._lamp_rays.depth)
        self._plane = plane_shadow(self._backdrop.on_table, self._view, self._lamp)

    def render(self, primitives: Primitives) -> Rendering:
        """Return the table with these shapes on and above it."""
        lamp, rays = self._lamp, self._rays
        cast(primitives, lamp.seen_from, _LAMP_GRAIN, lamp.shadow, self._lamp_rays.owner)
        cast(primitives, self._fine_view, SUPERSAMPLING, rays.depth, rays.owner)
        shade(primitives, self._fine_view, lamp, SUPERSAMPLING, rays)
        backdrop = self._backdrop
        light = cv2.GaussianBlur(plane_light(self._plane, lamp.shadow), (0, 0), _PENUMBRA_PX)
        image = backdrop.brightness * (AMBIENT + (1.0 - AMBIENT) * light)
        depth_m = backdrop.depth_m.copy()
        speckle = np.where(backdrop.on_table, _CLOTH_SPECKLE, _FLOOR_SPECKLE).astype(np.float32)
        flicker = _SPECKLE[primitives.material]
        met = _merge(rays, flicker, backdrop.light, image, speckle, depth_m)
        depth_m[~met & (light < 0.5)] = np.nan
        return Rendering(image, speckle, depth_m)


@njit(cache=True)
def _merge(
    rays: Rays, flicker: Image, light: Image, image: Image, speckle: Image, depth_m: Image
) -> NDArray[np.bool_]:
    """Average the rays of each pixel over what the backdrop shows there.

    What the backdrop hides, such as an end that hangs down behind the table's edge, is not seen.

    Args:
        rays: Finer than the image by `SUPERSAMPLING`.
        flicker: Speckle of each shape, (N,).
        light: Share of the lamp's light that arrives at a pixel.
        image: Brightness of the backdrop; is drawn over.
        speckle: Speckle of the backdrop; is drawn over.
        depth_m: Depth of the backdrop; becomes that of the nearest ray.

    Returns:
        Where a shape is seen, same shape as the image.
    """
    height, width = image.shape
    seen = np.zeros((height, width), np.bool_)
    count = SUPERSAMPLING * SUPERSAMPLING
    for v in range(height):
        for u in range(width):
            met, total, noise, nearest = 0, 0.0, 0.0, np.inf
            for ray in range(count):
                row = v * SUPERSAMPLING + ray // SUPERSAMPLING
                column = u * SUPERSAMPLING + ray % SUPERSAMPLING
                index = rays.owner[row, column]
                if index >= 0 and rays.depth[row, column] <= depth_m[v, u]:
                    met += 1
                    total += rays.brightness[row, column]
                    noise += flicker[index]
                    nearest = min(nearest, rays.depth[row, column])
            if met > 0:
                rest = 1.0 - met / count
                image[v, u] = rest * image[v, u] + light[v, u] * total / count
                speckle[v, u] = rest * speckle[v, u] + noise / count
                depth_m[v, u] = nearest
                seen[v, u] = True
    return seen


def _view(camera: CameraModel, finer: int) -> View:
    """Return the camera's view with `finer` times as many pixels in x and y."""
    cx, cy = ((finer * centre + 0.5 * (finer - 1)) for centre in camera.centre_px)
    return View(np.ascontiguousarray(camera.T_world_camera), finer * camera.focal_px, cx, cy)


def _no_rays(shape: tuple[int, int]) -> Rays:
    return Rays(np.zeros(shape, np.float32), np.zeros(shape, np.int32), np.zeros(shape, np.float32))


def _lamp_view(table_size_m: tuple[float, float]) -> tuple[View, tuple[int, int]]:
    """Return the lamp's view straight down, and its height and width [px]."""
    x, y, z = LAMP_POSITION_M
    half = 0.5 * np.asarray(table_size_m) + _SHADOW_MARGIN_M
    blocks = np.ceil(2.0 * half / (_SHADOW_TEXEL_M * _LAMP_GRAIN))
    width, height = _LAMP_GRAIN * blocks.astype(int)
    pose = np.diag([1.0, -1.0, -1.0, 1.0])
    pose[:3, 3] = LAMP_POSITION_M
    cx, cy = (x + half[0]) / _SHADOW_TEXEL_M, (half[1] - y) / _SHADOW_TEXEL_M
    return View(pose, z / _SHADOW_TEXEL_M, float(cx), float(cy)), (int(height), int(width))
