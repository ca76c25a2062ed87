"""From a plane curve to a cable in space: the upper strand of each crossing lifted."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from perception.cable.topology import StrandCrossing

Floats = NDArray[np.float64]

# How far along the strand a lift reaches on either side of its crossing, in nodes.
WIDEST = 3.5
# Of the way to the next lower visit of the same strand, a lift takes at most this share.
SHARE = 0.6


def lift_over(
    nodes_m: Floats,
    crossings: Sequence[StrandCrossing],
    first_over: Sequence[bool],
    height_m: float,
) -> Floats:
    """Lift one strand over the other at every crossing, in smooth bumps.

    Args:
        nodes_m: Centre line that lies flat, shape (N, 3).
        crossings: Where it crosses itself.
        first_over: For each crossing, whether the earlier visit is on top.
        height_m: How high the upper strand is lifted.

    Returns:
        The lifted centre line, shape (N, 3).
    """
    over, under = [], []
    for crossing, on_top in zip(crossings, first_over, strict=True):
        over.append(crossing.first if on_top else crossing.second)
        under.append(crossing.second if on_top else crossing.first)
    lifted = nodes_m.copy()
    index = np.arange(len(nodes_m), dtype=float)
    for arc in over:
        width = min(WIDEST, SHARE * float(np.abs(np.array(under) - arc).min()))
        bump = height_m * np.cos(0.5 * np.pi * np.clip((index - arc) / width, -1.0, 1.0)) ** 2
        lifted[:, 2] = np.maximum(lifted[:, 2], nodes_m[:, 2] + bump)
    return lifted
