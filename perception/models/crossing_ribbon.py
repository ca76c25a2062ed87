"""What the crossing's network sees: both strands of a crossing, each laid straight.

A ribbon is bent with its strand, so that whatever way a strand comes, it runs along the middle.
Training and classifying cut their ribbons with the same code.
"""

import cv2
import numpy as np
from scipy.ndimage import gaussian_filter1d

from perception.camera import GreyImage
from perception.models.frames import Crop, Floats, ScaledImage, scale_image

# A cable is this many units wide; a ribbon has one place a unit, along and across.
WIDTH = 8.0
ALONG, ACROSS = 65, 25
# Channels of a ribbon.
GREY, DISTANCE, ON_CABLE = range(3)
CHANNELS = 3
# Paths go on beyond a ribbon's ends, for smoothing.
MARGIN = 8
REACH = float(ALONG // 2 + MARGIN)
SMOOTHING = 2.4
# Distances to the other strand are told apart up to here.
FARTHEST = 1.5 * WIDTH
CORE, BESIDE = 0.3 * WIDTH, 0.8 * WIDTH
# Grey values that differ less are noise of the sensor.
LEAST_DEVIATION = 2.0


def scale_for_ribbons(image: GreyImage, width_px: float) -> ScaledImage:
    """Return an image in units of which cables are `WIDTH` wide; it is only ever made smaller."""
    return scale_image(image, width_px, WIDTH, min(width_px / WIDTH, 1.0))


def make_ribbons(scaled: ScaledImage, paths: Floats) -> Crop:
    """Return grey values and distance to the other strand, along both strands of each crossing.

    Args:
        scaled: From `scale_for_ribbons`.
        paths: Points of both strands, a unit apart, over `REACH` to either side of the crossing,
            shape (N, 2, K, 2).

    Returns:
        Ribbons, shape (N, 2, CHANNELS, ALONG, ACROSS): grey, distance, and grey as the cables
        have it. Grey values have mean 0 and deviation 1 over both ribbons of a crossing, cables
        on the bright side; the last channel has them over the cables alone.
    """
    smooth = gaussian_filter1d(paths, SMOOTHING, axis=2, mode="nearest")[:, :, MARGIN:-MARGIN]
    along = np.gradient(smooth, axis=2)
    along /= np.maximum(np.linalg.norm(along, axis=3, keepdims=True), 1e-9)
    across = np.stack([-along[..., 1], along[..., 0]], axis=-1)
    aside = np.linspace(-0.5, 0.5, ACROSS) * (ACROSS - 1)
    places = smooth[..., None, :] + aside[:, None] * across[..., None, :]
    ribbons = np.empty((len(paths), 2, CHANNELS, ALONG, ACROSS), np.float32)
    distances = _distances(places, smooth[:, ::-1], along[:, ::-1])
    ribbons[:, :, GREY], ribbons[:, :, ON_CABLE] = _normalised(
        _grey(scaled, places), distances, aside
    )
    ribbons[:, :, DISTANCE] = distances / FARTHEST
    return ribbons


def _grey(scaled: ScaledImage, places: Floats) -> Crop:
    pixels = ((places.reshape(-1, ACROSS, 2) + 0.5) * scaled.zoom - 0.5).astype(np.float32)
    # OpenCV's maps are at most 32767 rows long.
    rows = [
        cv2.remap(
            scaled.pixels,
            part[..., 0],
            part[..., 1],
            cv2.INTER_LINEAR,
            borderMode=cv2.BORDER_REPLICATE,
        )
        for part in np.array_split(pixels, len(pixels) // 30000 + 1)
    ]
    return np.vstack(rows).astype(np.float32).reshape(places.shape[:-1])


def _distances(places: Floats, other: Floats, along: Floats) -> Crop:
    """Return signed distances of places to the other strand, at most `FARTHEST`.

    Every second place and point is looked at; between them distances are interpolated.
    """
    coarse = places[:, :, ::2, ::2].astype(np.float32)
    flat = coarse.reshape(*coarse.shape[:2], -1, 2)
    points = other[:, :, ::2].astype(np.float32)
    squared = (flat**2).sum(-1)[..., None] + (points**2).sum(-1)[:, :, None]
    squared -= 2.0 * flat @ points.swapaxes(2, 3)
    nearest = squared.argmin(axis=3)[..., None]
    offset = flat - np.take_along_axis(points, nearest, 2)
    ahead = np.take_along_axis(along[:, :, ::2].astype(np.float32), nearest, 2)
    side = ahead[..., 0] * offset[..., 1] - ahead[..., 1] * offset[..., 0]
    gaps = np.linalg.norm(offset, axis=-1).clip(0.0, FARTHEST)
    return _doubled(np.copysign(gaps, side).reshape(coarse.shape[:-1]))


def _doubled(values: Crop) -> Crop:
    """Return maps with the means of neighbours between all rows and columns."""
    count = values.shape[:2]
    fine = np.empty((*count, ALONG, ACROSS), np.float32)
    fine[:, :, ::2, ::2] = values
    fine[:, :, 1::2, ::2] = 0.5 * (values[:, :, 1:] + values[:, :, :-1])
    fine[..., 1::2] = 0.5 * (fine[..., 2::2] + fine[..., :-1:2])
    return fine


def _normalised(grey: Crop, distances: Crop, aside: Floats) -> tuple[Crop, Crop]:
    """Return grey values as all of a crossing and as its cables have them.

    Cables are on the bright side of both. What tells strands apart is often a few grey values on
    a cable that differs from the table by a hundred; the second one keeps those.
    """
    own, other = np.abs(aside), np.abs(distances)
    on_cable = ((own < CORE) | (other < CORE)).astype(np.float32)
    on_table = ((own > BESIDE) & (other > BESIDE)).astype(np.float32)
    sign = np.where(_mean(grey, on_cable) < _mean(grey, on_table), -1.0, 1.0)
    everywhere = np.ones_like(on_cable)
    return _standard(grey, everywhere, sign, 4.0), _standard(grey, on_cable, sign, 3.0)


def _standard(grey: Crop, weights: Crop, sign: Crop, most: float) -> Crop:
    """Return values of mean 0 and deviation 1 where weights are, at most `most`, shape as grey."""
    centred = grey - _mean(grey, weights)[:, None, None, None]
    deviation = np.sqrt(_mean(centred**2, weights))
    gain = sign / np.maximum(deviation, LEAST_DEVIATION)
    standard: Crop = (centred * gain[:, None, None, None]).clip(-most, most)
    return standard


def _mean(grey: Crop, weights: Crop) -> Crop:
    total: Crop = (grey * weights).sum((1, 2, 3)) / np.maximum(weights.sum((1, 2, 3)), 1.0)
    return total
