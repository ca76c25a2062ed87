"""The grey sensor behind the lens: a little blur, speckle and read noise, eight bits."""

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from perception.camera import DepthImage, GreyImage
from simulation.render.renderer import Rendering

Image = NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class SensorParameters:
    """How the sensor departs from a perfect one.

    Attributes:
        blur_px: Standard deviation of the lens's blur.
        read_noise: Standard deviation of noise that is there in the dark, in grey values.
        speckle: Factor on the flicker of lit surfaces; 0 takes it away.
        depth_noise_m: Standard deviation of measured depth.
    """

    blur_px: float = 0.7
    read_noise: float = 0.8
    speckle: float = 1.0
    depth_noise_m: float = 0.0005


_SIDE_SHARE = 0.17  # how much of a pixel's noise its right-hand neighbour shares


def expose(rendering: Rendering, sensor: SensorParameters, rng: np.random.Generator) -> GreyImage:
    """Return the eight-bit image of a scene."""
    blurred = _blur(rendering.brightness, _kernel(sensor.blur_px))
    noise = rng.standard_normal(blurred.shape, np.float32)
    return _quantise(blurred, rendering.speckle, noise, sensor.speckle, sensor.read_noise)


def measure_depth(
    rendering: Rendering, sensor: SensorParameters, rng: np.random.Generator
) -> DepthImage:
    """Return the depth image of a scene [m]; NaN where nothing can be measured."""
    noise = rng.standard_normal(rendering.depth_m.shape, np.float32)
    return rendering.depth_m + np.float32(sensor.depth_noise_m) * noise


def _kernel(sigma_px: float) -> Image:
    """Return a Gaussian of five taps that sums to one."""
    offsets = np.arange(-2, 3)
    taps = np.exp(-0.5 * (offsets / max(sigma_px, 1e-3)) ** 2)
    return (taps / taps.sum()).astype(np.float32)


@njit(cache=True)
def _blur(image: Image, taps: Image) -> Image:
    height, width = image.shape
    across = image.copy()
    for v in range(height):
        for u in range(2, width - 2):
            total = np.float32(0.0)
            for tap in range(5):
                total += taps[tap] * image[v, u + tap - 2]
            across[v, u] = total
    down = across.copy()
    for v in range(2, height - 2):
        for u in range(width):
            total = np.float32(0.0)
            for tap in range(5):
                total += taps[tap] * across[v + tap - 2, u]
            down[v, u] = total
    return down


@njit(cache=True)
def _quantise(
    brightness: Image, speckle: Image, noise: Image, speckle_factor: float, read_noise: float
) -> GreyImage:
    height, width = brightness.shape
    image = np.empty((height, width), np.uint8)
    scale = 1.0 / np.sqrt(1.0 + _SIDE_SHARE**2)
    for v in range(height):
        left = 0.0
        for u in range(width):
            grey = 255.0 * brightness[v, u]
            spread = np.hypot(read_noise, speckle_factor * speckle[v, u] * grey)
            grey += spread * scale * (noise[v, u] + _SIDE_SHARE * left)
            left = noise[v, u]
            image[v, u] = np.uint8(min(max(grey + 0.5, 0.0), 255.0))
    return image
