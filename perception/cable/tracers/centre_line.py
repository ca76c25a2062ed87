"""From pixels of a skeleton to a smooth centre line."""

import numpy as np
from scipy.ndimage import gaussian_filter1d

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


def smooth(points: Points, sigma_px: float) -> Points:
    """Return the polyline without its pixel steps; both ends stay where they are.

    The line is continued by point reflection at both ends, which keeps ends and directions.
    """
    line = resample(points)
    sigma = sigma_px / SPACING_PX
    pad = min(int(4.0 * sigma) + 1, len(line) - 1)
    head = 2.0 * line[0] - line[pad:0:-1]
    tail = 2.0 * line[-1] - line[-2 : -pad - 2 : -1]
    extended = np.concatenate([head, line, tail])
    smoothed: Points = gaussian_filter1d(extended, sigma, axis=0, mode="nearest")
    return smoothed[pad : pad + len(line)]


def tangents(points: Points, reach: int = 3) -> Points:
    """Return unit tangents of a line over +-`reach` of its points, shape (N, 2)."""
    index = np.arange(len(points))
    ahead, behind = np.minimum(index + reach, len(points) - 1), np.maximum(index - reach, 0)
    chords = points[ahead] - points[behind]
    unit: Points = chords / np.maximum(np.linalg.norm(chords, axis=1, keepdims=True), 1e-9)
    return unit
