"""Lengths along a polyline and points on it; light enough for skills to import."""

import numpy as np
from numpy.typing import NDArray

from perception.cable.types import Points

SPACING_PX = 2.0


def arc_lengths(points: Points) -> Points:
    """Return the length of a polyline up to each of its points, shape (N,)."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    lengths: Points = np.concatenate([[0.0], np.cumsum(steps)])
    return lengths


def point_at(points: Points, arcs: Points, at: Points | float) -> Points:
    """Return points at arc lengths `at`, shape (K, 2), or (2,) for one."""
    return np.stack([np.interp(at, arcs, points[:, axis]) for axis in (0, 1)], axis=-1)


def resample(points: Points, spacing_px: float = SPACING_PX) -> Points:
    """Return a polyline with the same ends and nearly equal steps, shape (N, 2), N >= 2."""
    arcs = arc_lengths(points)
    count = max(round(arcs[-1] / spacing_px), 1)
    return point_at(points, arcs, np.linspace(0.0, arcs[-1], count + 1))


def pixels_of(
    points_px: Points, shape: tuple[int, ...]
) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
    """Return rows and columns of the pixels that points lie in, shape (N,) each.

    Args:
        points_px: Points, shape (N, 2); those outside count as the nearest pixel.
        shape: Height and width of the image.
    """
    limits = np.array([shape[1], shape[0]]) - 1
    columns, rows = np.rint(points_px).astype(int).clip(0, limits).T
    return rows, columns
