"""From pixels of a skeleton to a smooth centre line."""

import numpy as np
from scipy.ndimage import gaussian_filter1d

from perception.cable.polyline import SPACING_PX, arc_lengths, point_at, resample
from perception.cable.types import Points


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


def bend_between(before: Points, after: Points, reach_px: float) -> Points:
    """Return points on a cubic from the end of one line to the start of another.

    Args:
        before: A line, shape (N, 2).
        after: Another one, shape (M, 2).
        reach_px: Length of either line that gives its direction.

    Returns:
        About one point a pixel, both ends left out, shape (K, 2).
    """
    chord = after[0] - before[-1]
    gap_px = float(np.linalg.norm(chord))
    count = int(gap_px)
    if count < 2:
        return np.empty((0, 2))
    leaving, entering = _direction(before[::-1], reach_px), _direction(after, reach_px)
    start = -leaving if leaving is not None else chord / gap_px
    stop = entering if entering is not None else chord / gap_px
    t = (np.arange(1, count) / count)[:, None]
    cubic: Points = (
        (1.0 + 2.0 * t) * (1.0 - t) ** 2 * before[-1]
        + t * (1.0 - t) ** 2 * gap_px * start
        + t**2 * (3.0 - 2.0 * t) * after[0]
        - t**2 * (1.0 - t) * gap_px * stop
    )
    return cubic


def _direction(line: Points, reach_px: float) -> Points | None:
    """Return the unit direction in which a line starts; None where it is too short to say."""
    arcs = arc_lengths(line)
    if arcs[-1] < 0.3 * reach_px:
        return None
    chord = point_at(line, arcs, min(reach_px, float(arcs[-1]))) - line[0]
    unit: Points = chord / max(float(np.linalg.norm(chord)), 1e-9)
    return unit
