"""Make grey images of strands with a different look each time (domain randomisation)."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from perception.camera import GreyImage
from perception.training import backdrop, rasterise
from perception.training.connectors import (
    Connector,
    draw_connector,
    draw_distractors,
    draw_up_connectors,
)
from perception.training.waypoints import resample

Floats = NDArray[np.float64]
Picture = NDArray[np.float32]

# Share of scenes with things on the table that are neither cable nor connector.
DISTRACTED = 0.3


@dataclass(frozen=True, slots=True)
class CableLook:
    """How a cable looks; grey values in [0, 255], lengths in cable widths.

    Attributes:
        brightness: Grey value of its middle.
        braid_amplitude: How much the braid changes that.
        braid_period: Length of the braid's pattern.
        braid_slope: How far it runs askew.
        flank: How much darker its sides are.
        gloss: Highlight along it.
        uneven: How much its brightness changes along it, slowly.
        dimming: Brightness it gains or loses a width of height.
    """

    brightness: float
    braid_amplitude: float
    braid_period: float
    braid_slope: float
    flank: float
    gloss: float
    uneven: float
    dimming: float


@dataclass(frozen=True, slots=True)
class Look:
    """How a scene looks.

    Attributes:
        table: Grey value of the table.
        cables: One look a cable; often the same for all.
        light_rad: Direction that shadows fall in.
        slant: Length of a shadow over the height of what casts it.
        shadow: Share of light that a shadow takes away.
        blur_px: Standard deviation of the lens's blur.
        sharpen: Strength of unsharp masking.
        noise: Standard deviation of the sensor's noise.
        vignette: Loss of light in the corners.
        jpeg_quality: Quality of compression, None for none.
        connectors: Whether cables carry connectors.
    """

    table: float
    cables: tuple[CableLook, ...]
    light_rad: float
    slant: float
    shadow: float
    blur_px: float
    sharpen: float
    noise: float
    vignette: float
    jpeg_quality: int | None
    connectors: bool


def draw_look(rng: np.random.Generator, cables: int, bright: bool | None = None) -> Look:
    """Draw a look of a scene.

    Args:
        rng: Source of all randomness.
        cables: How many cables there are.
        bright: Whether cables are brighter than the table; None for two thirds of all.
    """
    contrast = rng.uniform(35.0, 190.0)
    dark = rng.uniform(5.0, 240.0 - contrast)
    drawn_bright = rng.random() < 0.67
    bright = drawn_bright if bright is None else bright
    table, cable = (dark, dark + contrast) if bright else (dark + contrast, dark)
    first = _cable_look(rng, cable)
    spread = rng.choice([0.0, 0.15])
    looks = tuple(
        CableLook(
            first.brightness * (1.0 + spread * rng.normal() * 0.5),
            first.braid_amplitude,
            first.braid_period,
            first.braid_slope,
            first.flank,
            first.gloss,
            first.uneven,
            first.dimming,
        )
        for _ in range(cables)
    )
    return Look(
        table=table,
        cables=looks,
        light_rad=rng.uniform(0.0, 2.0 * np.pi),
        slant=rng.uniform(0.0, 1.3),
        shadow=rng.choice([0.0, 1.0], p=[0.2, 0.8]) * rng.uniform(0.1, 0.65),
        blur_px=rng.uniform(0.2, 1.3),
        sharpen=rng.choice([0.0, 1.0], p=[0.6, 0.4]) * rng.uniform(0.2, 1.4),
        noise=rng.choice([0.0, 1.0], p=[0.1, 0.9]) * rng.uniform(0.5, 9.0),
        vignette=rng.uniform(0.0, 0.35),
        jpeg_quality=int(rng.integers(40, 95)) if rng.random() < 0.25 else None,
        connectors=bool(rng.random() < 0.7),
    )


def _cable_look(rng: np.random.Generator, brightness: float) -> CableLook:
    return CableLook(
        brightness,
        braid_amplitude=rng.choice([0.0, 1.0], p=[0.35, 0.65]) * rng.uniform(0.05, 0.45),
        braid_period=rng.uniform(0.35, 1.6),
        braid_slope=rng.uniform(0.5, 4.0),
        flank=rng.uniform(0.0, 0.75),
        gloss=rng.choice([0.0, 1.0]) * rng.uniform(5.0, 60.0),
        uneven=rng.choice([0.0, 1.0]) * rng.uniform(0.02, 0.15),
        dimming=rng.choice([0.0, 1.0]) * rng.uniform(-0.05, 0.05),
    )


def render(
    rng: np.random.Generator,
    strands: Sequence[Floats],
    width_px: float,
    size_px: tuple[int, int],
    look: Look,
) -> tuple[GreyImage, tuple[Connector, ...]]:
    """Return an image of strands (x, y, z) [px] on a table, and the connectors that it shows."""
    # Thin strands are drawn at twice the size, for smooth borders.
    scale = 2 if width_px < 8.0 else 1
    size = (size_px[0] * scale, size_px[1] * scale)
    width = width_px * scale
    table = backdrop.draw_table(rng, size_px, look.table, width_px)
    picture: Picture = cv2.resize(table, size[::-1]).astype(np.float32)
    connectors: list[Connector] = []
    if look.connectors:
        for k, (strand, cable) in enumerate(zip(strands, look.cables, strict=True)):
            connectors += draw_up_connectors(rng, k, strand, width_px, cable.brightness)
    if rng.random() < DISTRACTED:
        draw_distractors(rng, picture, width, look.cables[0].brightness)
    for connector in (each for each in connectors if each.covered):
        draw_connector(picture, connector, scale)
    middle = np.array([0.5 * (scale - 1), 0.5 * (scale - 1), 0.0])
    fine = [resample(strand * scale + middle, width / 6.0) for strand in strands]
    _draw_strands(picture, fine, width, look)
    for connector in (each for each in connectors if not each.covered):
        draw_connector(picture, connector, scale)
    small = cv2.resize(picture, size_px[::-1], interpolation=cv2.INTER_AREA)
    return photograph(rng, small.astype(np.float32), look), tuple(connectors)


def _draw_strands(picture: Picture, strands: Sequence[Floats], width: float, look: Look) -> None:
    """Draw strands and their shadows, in place."""
    size = picture.shape
    height, shadow = np.zeros(size, np.float32), np.zeros(size, np.float32)
    surface, unused = np.zeros((*size, 4), np.float32), np.zeros((*size, 4), np.float32)
    lean = look.slant * np.array([np.cos(look.light_rad), np.sin(look.light_rad)])
    for label, strand in enumerate(strands):
        rasterise.splat(strand, width / 2.0, float(label), height, surface)
        if look.shadow > 0.0:
            shifted = strand.copy()
            shifted[:, :2] += strand[:, 2:] * lean
            rasterise.splat(shifted, width / 2.0, float(label), shadow, unused)
    rasterise.shade(picture, height, surface, shadow, _looks(look, width))


def _looks(look: Look, width: float) -> Floats:
    return np.array(
        [
            [
                width / 2.0,
                cable.brightness,
                cable.braid_amplitude,
                cable.braid_period * width,
                cable.braid_slope,
                cable.flank,
                cable.gloss,
                look.light_rad,
                look.shadow,
                cable.uneven,
                cable.dimming / width,
            ]
            for cable in look.cables
        ]
    )


def photograph(rng: np.random.Generator, picture: Picture, look: Look) -> GreyImage:
    """Return what a camera makes of a picture: lens, sensor, sharpening, compression."""
    blurred: Picture = cv2.GaussianBlur(picture, (0, 0), look.blur_px).astype(np.float32)
    rows, columns = picture.shape
    y, x = np.ogrid[-1.0 : 1.0 : rows * 1j, -1.0 : 1.0 : columns * 1j]
    blurred *= (1.0 - 0.5 * look.vignette * (x * x + y * y)).astype(np.float32)
    if look.noise > 0.0:
        noise = rng.standard_normal(picture.shape, dtype=np.float32) * look.noise
        if rng.random() < 0.3:
            noise = 2.0 * cv2.GaussianBlur(noise, (0, 0), 0.7).astype(np.float32)
        blurred += noise
    if look.sharpen > 0.0:
        soft = cv2.GaussianBlur(blurred, (0, 0), 1.2).astype(np.float32)
        blurred += look.sharpen * (blurred - soft)
    image: GreyImage = np.clip(blurred, 0.0, 255.0).astype(np.uint8)
    if look.jpeg_quality is not None:
        _, packed = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, look.jpeg_quality])
        image = np.asarray(cv2.imdecode(packed, cv2.IMREAD_GRAYSCALE), np.uint8)
    return image
