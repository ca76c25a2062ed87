"""Thin a mask to lines one pixel wide."""

import numpy as np
from numpy.typing import NDArray

from perception.cable.mask import Bools

# Neighbours of a pixel (dy, dx): first the one above, then clockwise.
RING = ((-1, 0), (-1, 1), (0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1))


def thin(mask: Bools) -> Bools:
    """Return a skeleton one pixel wide (T. Y. Zhang and C. Y. Suen 1984), on pixel lists.

    Only pixels that are still set are looked at, so the cost follows the cable, not the image.
    """
    padded = np.zeros((mask.shape[0] + 2, mask.shape[1] + 2), dtype=np.uint8)
    padded[1:-1, 1:-1] = mask
    flat, row = padded.ravel(), padded.shape[1]
    offsets = [dy * row + dx for dy, dx in RING]
    pixels = np.flatnonzero(flat)
    changed = True
    while changed:
        changed = False
        for removable in _REMOVABLE:
            code = np.zeros(len(pixels), dtype=np.uint8)
            for bit, offset in enumerate(offsets):
                code |= flat[pixels + offset] << bit
            gone = removable[code]
            flat[pixels[gone]] = 0
            pixels = pixels[~gone]
            changed |= bool(gone.any())
    # What is left is two pixels wide in places; there, one after the other can go.
    for pixel in pixels.tolist():
        code_here = sum(int(flat[pixel + offset]) << bit for bit, offset in enumerate(offsets))
        if _SPARE[code_here]:
            flat[pixel] = 0
    return padded[1:-1, 1:-1].astype(bool)


def _tables() -> tuple[tuple[NDArray[np.bool_], NDArray[np.bool_]], NDArray[np.bool_]]:
    """Return which of 256 neighbourhoods lose their centre in each sub-iteration, and after."""
    bits = (np.arange(256)[:, None] >> np.arange(8)) & 1
    count = bits.sum(axis=1)
    rises = ((bits == 0) & (np.roll(bits, -1, axis=1) == 1)).sum(axis=1)
    up, right, down, left = bits[:, 0], bits[:, 2], bits[:, 4], bits[:, 6]
    border = (count >= 2) & (count <= 6) & (rises == 1)
    first = border & (up * right * down == 0) & (right * down * left == 0)
    second = border & (up * right * left == 0) & (up * down * left == 0)
    # Connectivity number (S. Yokoi et al. 1975): 1 where the centre is not needed to connect.
    off = 1 - bits
    needed = sum(off[:, k] * (1 - off[:, (k + 1) % 8] * off[:, (k + 2) % 8]) for k in (0, 2, 4, 6))
    corner = (up + down > 0) & (left + right > 0)
    return (first, second), (needed == 1) & (count >= 3) & corner


_REMOVABLE, _SPARE = _tables()
