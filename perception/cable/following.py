"""How far a traced path follows a true centre line."""

import numpy as np
from numpy.typing import NDArray

from perception.cable.polyline import resample

Floats = NDArray[np.float64]

TRUTH_SPACING_PX = 4.0
PATH_SPACING_PX = 2.0


def followed_share(
    truth_px: Floats, path_px: Floats, tolerance_px: float = 8.0, gap_px: float = 24.0
) -> float:
    """Return which share of a true line a path follows from the line's start.

    The true line, resampled at 4 px, must be matched in order by one monotone run of the
    path: each point within the tolerance, and no more than `gap_px` of path between them.
    """
    truth = resample(truth_px, TRUTH_SPACING_PX)
    path = resample(path_px, PATH_SPACING_PX)
    near = np.linalg.norm(truth[:, None] - path[None], axis=2) <= tolerance_px
    reach = int(gap_px / PATH_SPACING_PX)
    reached = near[0]
    for number, row in enumerate(near):
        if number:
            reached = _widened(reached, reach) & row
        if not reached.any():
            return number / len(truth)
    return 1.0


def _widened(places: NDArray[np.bool_], reach: int) -> NDArray[np.bool_]:
    """Return the places that lie at most `reach` after a given one."""
    sums = np.cumsum(places)
    before = np.concatenate([np.zeros(reach + 1, dtype=sums.dtype), sums])[: len(sums)]
    widened: NDArray[np.bool_] = sums > before
    return widened
