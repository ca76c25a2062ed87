"""What the camera sees when the table is empty: cloth on foam, its edge, the dark room below.

All of it is synthetic and fixed for a seed: weave, soft folds, light that falls off, the
projector's faint bands.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from perception.camera import CameraModel

Floats = NDArray[np.float64]
Image = NDArray[np.float32]

FLOOR_HEIGHT_M = -0.75
_CLOTH, _HANGING, _FLOOR = 0.245, 0.125, 0.17
_LINT = 12  # bits of fluff on the cloth
_HEM_M = 0.07  # how far the cloth hangs over the table's edge, as seen from above


@dataclass(frozen=True, slots=True, eq=False)
class Backdrop:
    """The empty table in an image.

    Attributes:
        brightness: Without shadows, shape (height, width); 1.0 is white.
        light: How much of the lamp's light arrives, same shape; also dims what lies on top.
        on_table: Where the table's surface z = 0 is seen.
        depth_m: Distance along the view.
    """

    brightness: Image
    light: Image
    on_table: NDArray[np.bool_]
    depth_m: Image


def make_backdrop(
    camera: CameraModel, table_size_m: tuple[float, float], rng: np.random.Generator
) -> Backdrop:
    """Return the empty table as that camera sees it."""
    shape = (camera.height_px, camera.width_px)
    points = _table_points(camera)
    beyond_m = _distance_beyond(points, table_size_m, rng)
    light = _light(shape, rng)
    on_table = beyond_m <= 0.0
    cloth = _CLOTH * (1.0 + _weave(shape, rng) + _folds(points, beyond_m, rng))
    around = np.where(beyond_m < _HEM_M, _HANGING, _FLOOR * (1.0 + _planks(points, rng)))
    brightness = light * np.where(on_table, np.maximum(cloth, _lint(shape, rng)), around)
    brightness = _blurred(brightness, 0.6)
    height_m = camera.T_world_camera[2, 3]
    depth_m = np.where(on_table, height_m, height_m - FLOOR_HEIGHT_M)
    return Backdrop(
        brightness.astype(np.float32), light.astype(np.float32), on_table,
        depth_m.astype(np.float32),
    )  # fmt: skip


def _table_points(camera: CameraModel) -> Floats:
    """Return where the ray of each pixel meets z = 0, shape (height, width, 2) [m]."""
    v, u = np.mgrid[: camera.height_px, : camera.width_px]
    pixels = np.column_stack([u.ravel(), v.ravel()]).astype(np.float64)
    return camera.on_plane(pixels)[:, :2].reshape(camera.height_px, camera.width_px, 2)


def _smooth_noise(shape: tuple[int, int], sigma_px: float, rng: np.random.Generator) -> Floats:
    """Return noise of unit variance that changes over about `sigma_px`."""
    coarser = max(1, int(0.5 * sigma_px))
    size = (shape[0] // coarser + 1, shape[1] // coarser + 1)
    noise = _blurred(rng.standard_normal(size), sigma_px / coarser)
    if coarser > 1:
        noise = np.asarray(cv2.resize(noise, shape[::-1], None, 0, 0, cv2.INTER_CUBIC), np.float64)
    noise = noise[: shape[0], : shape[1]]
    return noise / noise.std()


def _blurred(image: Floats, sigma_px: float) -> Floats:
    return np.asarray(cv2.GaussianBlur(image, (0, 0), sigma_px), np.float64)


def _distance_beyond(
    points: Floats, table_size_m: tuple[float, float], rng: np.random.Generator
) -> Floats:
    """Return how far each point lies outside the table [m]; the cloth's edge waves a little."""
    half = 0.5 * np.asarray(table_size_m)
    wave_m = 0.0012 * _smooth_noise(points.shape[:2], 40.0, rng)
    return (np.abs(points) - half).max(axis=2) + wave_m


def _light(shape: tuple[int, int], rng: np.random.Generator) -> Floats:
    """Return the lamp's cone and its faint horizontal bands; 1 is full light."""
    v, u = np.mgrid[: shape[0], : shape[1]] / np.array(shape)[:, None, None]
    cone = 1.06 - 1.15 * (u - 0.42) ** 2 - 0.75 * (v - 0.58) ** 2
    bands = _blurred(rng.standard_normal((shape[0], 1)), 12.0)[:, 0]
    band = np.exp(-0.5 * ((v - rng.uniform(0.5, 0.65)) / 0.025) ** 2)
    return cone * (1.0 + 0.015 * (bands / bands.std())[:, None] + 0.06 * band)


def _weave(shape: tuple[int, int], rng: np.random.Generator) -> Floats:
    """Return the relative brightness of threads and pile."""
    fine = _smooth_noise(shape, 0.7, rng)
    threads = rng.standard_normal((shape[0], 1)) + rng.standard_normal((1, shape[1]))
    return 0.022 * fine + 0.014 * _smooth_noise(shape, 6.0, rng) + 0.006 * threads


def _folds(points: Floats, beyond_m: Floats, rng: np.random.Generator) -> Floats:
    """Return soft folds over the table and a bright rim where the cloth turns down."""
    folds = np.zeros(points.shape[:2])
    for _ in range(5):
        angle, offset_m = rng.normal(0.0, 0.35), rng.uniform(-0.36, 0.36)
        across = points[..., 1] - offset_m - np.tan(angle) * points[..., 0]
        across += 0.02 * np.sin(points[..., 0] * rng.uniform(4.0, 9.0) + rng.uniform(0.0, 6.0))
        width_m = rng.uniform(0.006, 0.02)
        # Light comes from the side: one flank of a fold is brighter, the other darker.
        slope = across / width_m * np.exp(-0.5 * (across / width_m) ** 2)
        reach = np.exp(-0.5 * ((points[..., 0] - rng.uniform(-0.5, 0.5)) / 0.2) ** 2)
        folds += rng.uniform(0.03, 0.09) * slope * reach
    rim = np.exp(-0.5 * ((beyond_m + 0.004) / 0.004) ** 2)
    return folds + 0.10 * rim - 0.05 * np.exp(-0.5 * ((beyond_m + 0.025) / 0.012) ** 2)


def _lint(shape: tuple[int, int], rng: np.random.Generator) -> Floats:
    """Return a few fibres and specks of dust, brighter than the cloth, on black."""
    lint = np.zeros(shape, np.float32)
    for _ in range(_LINT):
        start = rng.uniform(0.0, shape[::-1])
        end = start + rng.normal(0.0, 3.0, 2)
        first, last = ([int(16 * c) for c in point] for point in (start, end))
        cv2.line(lint, first, last, rng.uniform(0.3, 0.5), 1, cv2.LINE_AA, 4)
    return np.asarray(lint, np.float64)


def _planks(points: Floats, rng: np.random.Generator) -> Floats:
    """Return the grain of a wooden floor, along y."""
    grain = cv2.GaussianBlur(rng.standard_normal(points.shape[:2]), (0, 0), sigmaX=0.9, sigmaY=12.0)
    return np.asarray(0.06 * grain / grain.std(), np.float64)
