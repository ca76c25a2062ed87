"""Where two traces of one cable part."""

import numpy as np

from perception.cable.polyline import resample
from perception.cable.types import Points

SPACING_PX = 3.0
# Traces that lie this near follow one strand.
TOGETHER_PX = 8.0
# While both follow one strand, they come forward about alike.
LOOK_AHEAD = 5


def parting_arc(line: Points, other: Points) -> float | None:
    """Return how far along a trace another one from the same end leaves it [px].

    Args:
        line: One trace, shape (N, 2).
        other: Another, either way round, shape (M, 2).

    Returns:
        Length of the first from its start to where they part; None where they never do.
    """
    if np.linalg.norm(other[-1] - line[0]) < np.linalg.norm(other[0] - line[0]):
        other = other[::-1]
    a, b = resample(line, SPACING_PX), resample(other, SPACING_PX)
    at = 0
    for k, point in enumerate(a):
        gaps = np.linalg.norm(b[at : at + LOOK_AHEAD] - point, axis=1)
        at += int(gaps.argmin())
        if gaps.min() > TOGETHER_PX:
            return max(0, k - 1) * SPACING_PX
    left_px = (len(b) - 1 - at) * SPACING_PX
    return (len(a) - 1) * SPACING_PX if left_px > 2.0 * TOGETHER_PX else None
