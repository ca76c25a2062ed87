"""Image files of the user as grey arrays, and the other way round."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from executive.core.errors import InputError

MIN_SIDE_PX = 32


def read_grey(path: Path) -> NDArray[np.uint8]:
    """Return an image file as grey values, shape (height, width).

    Args:
        path: PNG, JPEG or any other format that Pillow reads; colours become grey, 16-bit
            values are scaled to 8 bits, and a camera's orientation tag is followed.

    Raises:
        InputError: There is no such file, it is no image, or it is too small.
    """
    from PIL import Image, ImageOps, UnidentifiedImageError

    try:
        with Image.open(path) as image:
            upright = ImageOps.exif_transpose(image)
            pixels = np.asarray(upright if upright.mode.startswith("I") else upright.convert("L"))
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; expected an image") from None
    except (UnidentifiedImageError, Image.DecompressionBombError, SyntaxError) as error:
        raise InputError(f"{path}: not an image; got {error}; try PNG or JPEG") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read as an image: {error}; try PNG or JPEG") from None
    if min(pixels.shape) < MIN_SIDE_PX:
        raise InputError(
            f"{path}: too small; got {pixels.shape[1]} x {pixels.shape[0]} px; "
            f"expected at least {MIN_SIDE_PX} px each way"
        )
    return pixels if pixels.dtype == np.uint8 else (pixels >> 8).clip(0, 255).astype(np.uint8)


def write_image(path: Path, pixels: NDArray[np.uint8]) -> None:
    """Write an image file; its format is that of the name.

    Raises:
        InputError: The file cannot be written, or its name says no known format.
    """
    from PIL import Image

    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        Image.fromarray(pixels).save(path)
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be written: {error}; try a name with .png") from None
