"""Make grey images of strands with a given look."""

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from perception.camera import GreyImage
from perception.training import rasterise
from perception.training.backdrop import draw_table
from perception.training.connectors import Connector, draw_connectors, draw_up_connectors
from perception.training.looks import Light, Look
from perception.training.photograph import light_up, photograph
from perception.training.waypoints import resample

Floats = NDArray[np.float64]
Picture = NDArray[np.float32]

# Strands thinner than this are drawn at twice the size, for smooth borders [px].
THIN_PX = 8.0


def render(
    rng: np.random.Generator,
    strands: Sequence[Floats],
    width_px: float,
    size_px: tuple[int, int],
    look: Look,
    shots: int = 1,
) -> tuple[tuple[GreyImage, ...], tuple[Connector, ...]]:
    """Return images of strands (x, y, z) [px] on a table, and the connectors that they show.

    All `shots` show the same, each in light and with noise of its own.
    """
    scale = 2 if look.lens.smooth and width_px < THIN_PX else 1
    size, width = (size_px[0] * scale, size_px[1] * scale), width_px * scale
    picture: Picture = draw_table(rng, size_px, look.table, width_px)
    if scale > 1:
        picture = cv2.resize(picture, size[::-1]).astype(np.float32)
    connectors = _connectors(rng, strands, width_px, look)
    draw_connectors(picture, [each for each in connectors if each.covered], scale)
    middle = np.array([0.5 * (scale - 1), 0.5 * (scale - 1), 0.0])
    fine = [resample(strand * scale + middle, width / 4.0) for strand in strands]
    _draw_strands(picture, fine, width, look)
    draw_connectors(picture, [each for each in connectors if not each.covered], scale)
    if scale > 1:
        small = cv2.resize(picture, size_px[::-1], interpolation=cv2.INTER_AREA)
        picture = small.astype(np.float32)
    images = tuple(
        photograph(rng, light_up(rng, picture, look.light), width_px, look.lens)
        for _ in range(shots)
    )
    return images, tuple(connectors)


def _connectors(
    rng: np.random.Generator, strands: Sequence[Floats], width_px: float, look: Look
) -> list[Connector]:
    if not look.connectors:
        return []
    return [
        connector
        for k, (strand, cable) in enumerate(zip(strands, look.cables, strict=True))
        for connector in draw_up_connectors(
            rng, k, strand, cable.width * width_px, cable.brightness
        )
    ]


def _draw_strands(picture: Picture, strands: Sequence[Floats], width: float, look: Look) -> None:
    """Draw strands and their shadows, in place."""
    size, light = picture.shape, look.light
    height, shadow = np.zeros(size, np.float32), np.zeros(size, np.float32)
    surface, none = np.zeros((*size, 4), np.float32), np.zeros((0, 0, 4), np.float32)
    lean = light.slant * np.array([np.cos(light.light_rad), np.sin(light.light_rad)])
    for label, (strand, cable) in enumerate(zip(strands, look.cables, strict=True)):
        radius = 0.5 * cable.width * width
        rasterise.splat(strand, radius, float(label), height, surface)
        if light.shadow > 0.0:
            shifted = strand.copy()
            shifted[:, :2] += strand[:, 2:] * lean
            rasterise.splat(shifted, radius, float(label), shadow, none)
    if light.shadow > 0.0:
        picture *= 1.0 - np.float32(light.shadow) * _on_table(shadow, width, light)
    rasterise.shade(picture, height, surface, shadow, _looks(look, width))


def _on_table(shadow: Picture, width: float, light: Light) -> Picture:
    """Return which share of a shadow lies on the table, wider and softer than what casts it."""
    dark = (shadow > 0.0).astype(np.uint8) * np.uint8(255)
    wider = round(0.5 * (light.spread - 1.0) * width)
    if wider > 0:
        dark = cv2.dilate(dark, np.ones((2 * wider + 1,) * 2, np.uint8)).astype(np.uint8)
    side = 2 * round(light.softness * width) + 1
    # Two running means come close to a Gaussian, at a cost that does not grow with its width.
    soft = cv2.blur(cv2.blur(dark, (side, side)), (side, side)) if side > 1 else dark
    return soft.astype(np.float32) / np.float32(255.0)


def _looks(look: Look, width: float) -> Floats:
    return np.array(
        [
            [
                0.5 * cable.width * width,
                cable.brightness,
                cable.braid_amplitude,
                cable.braid_period * width,
                cable.braid_slope,
                cable.flank,
                cable.gloss,
                look.light.light_rad,
                look.light.shadow,
                cable.uneven,
                cable.dimming / width,
                cable.gloss_sharpness,
                cable.stripe,
                cable.stripe_period * width,
                cable.stripe_slope,
                cable.stripe_share,
                cable.outline,
                cable.bead,
                cable.bead_period * width,
                cable.facing,
                cable.facets,
                np.arctan(look.light.slant),
            ]
            for cable in look.cables
        ]
    )
