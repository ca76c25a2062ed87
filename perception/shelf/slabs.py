"""The compiled part of casting: rays clipped against the slabs of cuboids, pixel by pixel."""

import numba
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

kernel = numba.njit(cache=True, error_model="numpy")


@kernel
def _hit(inverse: Floats, low: Floats, high: Floats) -> float:
    """Return where a ray enters a cuboid, or -1 where it misses it or starts in it."""
    near, far = -np.inf, np.inf
    for axis in range(3):
        one, other = low[axis] * inverse[axis], high[axis] * inverse[axis]
        near, far = max(near, min(one, other)), min(far, max(one, other))
    return near if near <= far and near > 0.0 else -1.0


@kernel
def cast_boxes(
    inverse: Floats, low_m: Floats, high_m: Floats, first: Ints, last: Ints, width_px: int
) -> tuple[Ints, Floats, Ints]:
    """Return pixels, depths and boxes of all hits, box after box, row after row.

    Args:
        inverse: One over each component of each ray, shape (P, 3).
        low_m: Lower corners, from the camera, shape (N, 3).
        high_m: Upper corners, the same.
        first: First row and column that may show each box, inside the image, shape (N, 2).
        last: Last ones, the same.
        width_px: Width of the image.
    """
    room = 0
    for box in range(len(low_m)):
        rows, columns = last[box, 0] - first[box, 0] + 1, last[box, 1] - first[box, 1] + 1
        room += max(rows, 0) * max(columns, 0)
    pixel, depth = np.empty(room, np.int64), np.empty(room)
    owner = np.empty(room, np.int64)
    count = 0
    for box in range(len(low_m)):
        for row in range(first[box, 0], last[box, 0] + 1):
            for column in range(first[box, 1], last[box, 1] + 1):
                at = row * width_px + column
                near = _hit(inverse[at], low_m[box], high_m[box])
                if near > 0.0:
                    pixel[count], depth[count], owner[count] = at, near, box
                    count += 1
    return pixel[:count].copy(), depth[:count].copy(), owner[:count].copy()
