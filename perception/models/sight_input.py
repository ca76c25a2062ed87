"""Images as the detector sees them: brightness and contrast taken out, near and far."""

import cv2
import numpy as np
from numpy.typing import NDArray

from perception.camera import GreyImage

Maps = NDArray[np.float32]

CHANNELS = 2
STRIDE = 4
# The sides of what the network sees are multiples of this.
MULTIPLE = 32
# Side of the square that local contrast is measured in.
NEAR_PX = 65
# Least contrasts, against noise on an even table: of the image, and of a place as a share of it.
LEAST, LEAST_SHARE = 4.0, 0.25
BRIGHTEST = 6.0


def prepare(image: GreyImage) -> Maps:
    """Return the image relative to all of itself, and to its surroundings.

    Args:
        image: Grey image, shape (H, W).

    Returns:
        Shape (CHANNELS, H', W'), sides rounded up to multiples of `MULTIPLE`; what is
        beyond the border is mirrored, as repeated noise would look like thin strands.
    """
    rows, columns = image.shape
    padded = cv2.copyMakeBorder(
        image, 0, -rows % MULTIPLE, 0, -columns % MULTIPLE, cv2.BORDER_REFLECT_101
    )
    whole = max(float(cv2.meanStdDev(image)[1][0, 0]), LEAST)
    window = (NEAR_PX, NEAR_PX)
    middle = cv2.boxFilter(padded, cv2.CV_32F, window, borderType=cv2.BORDER_REFLECT_101)
    square = cv2.sqrBoxFilter(padded, cv2.CV_32F, window, borderType=cv2.BORDER_REFLECT_101)
    near = np.sqrt(np.maximum(square - middle * middle, 0.0) + np.float32(LEAST_SHARE * whole) ** 2)
    maps = np.empty((CHANNELS, *padded.shape), np.float32)
    levels = (np.arange(256, dtype=np.float32) - _median(image)) / np.float32(whole)
    maps[0] = levels.clip(-BRIGHTEST, BRIGHTEST)[padded]
    np.subtract(padded, middle, out=maps[1])
    np.divide(maps[1], near, out=maps[1])
    np.clip(maps[1], -BRIGHTEST, BRIGHTEST, out=maps[1])
    return maps


def _median(image: GreyImage) -> np.float32:
    counts = cv2.calcHist([image], [0], None, [256], [0.0, 256.0])
    return np.float32(np.searchsorted(np.cumsum(counts, dtype=float), 0.5 * image.size))
