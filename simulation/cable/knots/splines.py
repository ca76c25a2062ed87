"""Smooth curves through corners, with points evenly spaced."""

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

Floats = NDArray[np.float64]


def smooth(corners_m: Floats, spacing_m: float) -> Floats:
    """Return points evenly spaced on a centripetal cubic spline through corners, shape (N, D)."""
    chords = np.linalg.norm(np.diff(corners_m, axis=0), axis=1)
    knots = np.concatenate([[0.0], np.cumsum(np.sqrt(chords))])
    dense = CubicSpline(knots, corners_m)(np.linspace(0.0, knots[-1], 40 * len(knots)))
    return evenly(dense, spacing_m)


def evenly(points_m: Floats, spacing_m: float) -> Floats:
    """Return points of a polyline at equal arc lengths, as near to the spacing as fits."""
    steps_m = np.linalg.norm(np.diff(points_m, axis=0), axis=1)
    arcs_m = np.concatenate([[0.0], np.cumsum(steps_m)])
    wanted = np.linspace(0.0, arcs_m[-1], max(2, round(arcs_m[-1] / spacing_m) + 1))
    return np.column_stack([np.interp(wanted, arcs_m, axis) for axis in points_m.T])
