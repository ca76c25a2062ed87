"""Smooth curves through waypoints, all lengths in cable widths."""

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.ndimage import gaussian_filter1d

Points = NDArray[np.float64]

SPACING = 0.5
# A hairpin is where a line comes back to this share of its way.
HAIRPIN_SHARE = 0.5


def resample(points: Points, spacing: float = SPACING) -> Points:
    """Return points at equal arc distances along a polyline, both ends kept."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    count = max(round(float(along[-1]) / spacing) + 1, 2)
    targets = np.linspace(0.0, along[-1], count)
    return np.column_stack([np.interp(targets, along, axis) for axis in points.T])


def through(waypoints: Points, stiffness: float) -> Points:
    """Return a smooth curve near waypoints; `stiffness` is the length it is smoothed over."""
    chords = np.linalg.norm(np.diff(waypoints, axis=0), axis=1)
    at = np.concatenate([[0.0], np.cumsum(np.sqrt(chords) + 1e-6)])
    fine = np.linspace(0.0, at[-1], 40 * len(waypoints))
    curve = resample(CubicSpline(at, waypoints)(fine))
    smooth = gaussian_filter1d(curve, stiffness / SPACING, axis=0, mode="nearest")
    return resample(smooth)


def hairpin_nodes(line: Points, reach: int) -> NDArray[np.int64]:
    """Return the nodes about which a line turns back within so many nodes to either side."""
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    ways = along[2 * reach :] - along[: -2 * reach]
    chords = np.linalg.norm(line[2 * reach :] - line[: -2 * reach], axis=1)
    return np.flatnonzero(chords < HAIRPIN_SHARE * ways) + reach
