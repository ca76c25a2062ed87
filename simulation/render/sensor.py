"""The grey sensor behind the lens: a little blur, speckle and read noise, eight bits."""

from dataclasses import dataclass

import cv2
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
    blurred = _blur(rendering.brightness, sensor.blur_px)
    noise = rng.standard_normal(blurred.shape, np.float32)
    return _quantise(blurred, rendering.speckle, noise, sensor.speckle, sensor.read_noise)


def measure_depth(
    rendering: Rendering, sensor: SensorParameters, rng: np.random.Generator
) -> DepthImage:
    """Return the depth image of a scene [m]; NaN where nothing can be measured."""
    noise = rng.standard_normal(rendering.depth_m.shape, np.float32)
    return rendering.depth_m + np.float32(sensor.depth_noise_m) * noise


def _blur(image: Image, sigma_px: float) -> Image:
    if sigma_px == 0.0:
        return image
    return np.asarray(cv2.GaussianBlur(image, (0, 0), sigma_px), np.float32)


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
            flicker = speckle_factor * speckle[v, u] * grey
            spread = np.sqrt(read_noise * read_noise + flicker * flicker)
            grey += spread * scale * (noise[v, u] + _SIDE_SHARE * left)
            left = noise[v, u]
            image[v, u] = np.uint8(min(max(grey + 0.5, 0.0), 255.0))
    return image
