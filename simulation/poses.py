"""Poses as arrays."""

import numba
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def pose_matrices(positions_m: Floats, quats_xyzw: Floats) -> Floats:
    """Return homogeneous matrices, shape (N, 4, 4).

    Args:
        positions_m: Shape (N, 3).
        quats_xyzw: Unit quaternions, shape (N, 4).
    """
    matrices: Floats = _matrices(positions_m, quats_xyzw)
    return matrices


@numba.njit(cache=True)
def _matrices(positions_m: Floats, quats_xyzw: Floats) -> Floats:
    # Hands are asked for at every step of a world; arrays would take ten times as long.
    matrices = np.zeros((len(positions_m), 4, 4))
    for n in range(len(positions_m)):
        x, y, z, w = quats_xyzw[n, 0], quats_xyzw[n, 1], quats_xyzw[n, 2], quats_xyzw[n, 3]
        matrices[n, 0, 0] = 1.0 - 2.0 * (y * y + z * z)
        matrices[n, 0, 1] = 2.0 * (x * y - z * w)
        matrices[n, 0, 2] = 2.0 * (x * z + y * w)
        matrices[n, 1, 0] = 2.0 * (x * y + z * w)
        matrices[n, 1, 1] = 1.0 - 2.0 * (x * x + z * z)
        matrices[n, 1, 2] = 2.0 * (y * z - x * w)
        matrices[n, 2, 0] = 2.0 * (x * z - y * w)
        matrices[n, 2, 1] = 2.0 * (y * z + x * w)
        matrices[n, 2, 2] = 1.0 - 2.0 * (x * x + y * y)
        matrices[n, :3, 3] = positions_m[n]
        matrices[n, 3, 3] = 1.0
    return matrices
