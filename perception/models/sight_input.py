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
        Shape (CHANNELS, H', W'), sides rounded up to multiples of `MULTIPLE`; the border is
        repeated.
    """
    rows, columns = image.shape
    grey = cv2.copyMakeBorder(
        image, 0, -rows % MULTIPLE, 0, -columns % MULTIPLE, cv2.BORDER_REPLICATE
    ).astype(np.float32)
    whole = max(float(image.std()), LEAST)
    window = (NEAR_PX, NEAR_PX)
    middle = cv2.blur(grey, window, borderType=cv2.BORDER_REPLICATE)
    square = cv2.blur(grey * grey, window, borderType=cv2.BORDER_REPLICATE)
    near = np.sqrt(np.maximum(square - middle * middle, 0.0) + (LEAST_SHARE * whole) ** 2)
    maps = np.stack([(grey - float(np.median(image))) / whole, (grey - middle) / near])
    clipped: Maps = np.clip(maps, -BRIGHTEST, BRIGHTEST)
    return clipped
