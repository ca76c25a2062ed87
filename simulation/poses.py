"""Poses as arrays."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def pose_matrices(positions_m: Floats, quats_xyzw: Floats) -> Floats:
    """Return homogeneous matrices, shape (N, 4, 4).

    Args:
        positions_m: Shape (N, 3).
        quats_xyzw: Unit quaternions, shape (N, 4).
    """
    x, y, z, w = quats_xyzw.T
    matrices = np.zeros((len(positions_m), 4, 4))
    matrices[:, 0, 0] = 1.0 - 2.0 * (y * y + z * z)
    matrices[:, 0, 1] = 2.0 * (x * y - z * w)
    matrices[:, 0, 2] = 2.0 * (x * z + y * w)
    matrices[:, 1, 0] = 2.0 * (x * y + z * w)
    matrices[:, 1, 1] = 1.0 - 2.0 * (x * x + z * z)
    matrices[:, 1, 2] = 2.0 * (y * z - x * w)
    matrices[:, 2, 0] = 2.0 * (x * z - y * w)
    matrices[:, 2, 1] = 2.0 * (y * z + x * w)
    matrices[:, 2, 2] = 1.0 - 2.0 * (x * x + y * y)
    matrices[:, :3, 3] = positions_m
    matrices[:, 3, 3] = 1.0
    return matrices
