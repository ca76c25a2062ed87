"""What the tracer's network sees: a crop turned to the cable's direction, and the path so far.

Training and tracing build their crops with the same code, from images in which the cable is
`WIDTH` units wide. Places are in units; how many pixels a unit has, the image's zoom, is a
network's own.
"""

import numpy as np

from perception.camera import GreyImage
from perception.models.frames import Crop, CropFrame, Floats, ScaledImage, cut, draw_line

SIZE = 64
CELL = 2
WIDTH = 4.5
STEP = 2.0 * WIDTH
# Half-way between rows, so that a crop turned upside down is a crop again.
HERE = (24.0, 31.5)
RECENT_STEPS = 12
FADING = 0.85
THICKNESS = 2


def make_crop(scaled: ScaledImage, path: Floats, frame: CropFrame) -> Crop:
    """Return grey, recent path and whole path, shape (3, P, P) with P = SIZE * zoom.

    Args:
        scaled: Image in which cables are `WIDTH` units wide.
        path: Points about one step apart in that image, oldest first, shape (N, 2).
        frame: Has the last point at `HERE` and the last step to the right.
    """
    zoom, pixels = scaled.zoom, round(SIZE * scaled.zoom)
    points, thickness = (frame.into(path) + 0.5) * zoom - 0.5, round(THICKNESS * zoom)
    recent = np.zeros((pixels, pixels), np.uint8)
    for k in range(max(len(points) - RECENT_STEPS, 0), len(points) - 1):
        draw_line(recent, points[k : k + 2], int(255 * FADING ** (len(points) - 2 - k)), thickness)
    whole = np.zeros((pixels, pixels), np.uint8)
    draw_line(whole, points, 255, thickness)
    crop = np.empty((3, pixels, pixels), np.float32)
    crop[0] = _normalised(cut(scaled, frame, SIZE), recent)
    crop[1], crop[2] = recent / np.float32(255.0), whole / np.float32(255.0)
    return crop


def _normalised(grey: Crop, recent: GreyImage) -> Crop:
    """Return grey values of mean 0 and deviation 1, the cable behind us on the bright side."""
    mean, deviation = float(grey.mean()), float(grey.std())
    behind = recent > 100
    dark = behind.any() and float(grey[behind].mean()) < mean
    gain = (-1.0 if dark else 1.0) / max(deviation, 2.0)
    normalised: Crop = np.clip((grey - mean) * gain, -4.0, 4.0)
    return normalised
