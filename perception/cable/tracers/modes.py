"""Distinct places among which a heat map of the next point divides its belief."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from perception.models.tracer_crop import CELL

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Mode:
    """One place where the cable may go on.

    Attributes:
        point_crop: Where, in crop pixels, shape (2,).
        probability: Belief in it.
    """

    point_crop: Floats
    probability: float


def find_modes(cells: Floats, least: float, most: int, reach: int = 2) -> tuple[Mode, ...]:
    """Return the modes of a heat map, most likely first.

    Args:
        cells: Probability of each cell, shape (G, G).
        least: Modes with less probability are left out.
        most: Return at most so many.
        reach: A mode takes the cells up to this far from its peak.
    """
    rows, columns = cells.shape
    # A frame of zeros, without the cost of a general padding: this runs at every step.
    left = np.zeros((rows + 2 * reach, columns + 2 * reach))
    left[reach:-reach, reach:-reach] = cells
    around = np.arange(-reach, reach + 1)
    modes = []
    for _ in range(most):
        row, column = divmod(int(left.argmax()), left.shape[1])
        # A peak in the frame of zeros means that nothing is left.
        if left[row, column] <= 0.0:
            break
        window = left[row - reach : row + reach + 1, column - reach : column + reach + 1]
        mass = float(window.sum())
        if mass < least:
            break
        offset = np.array([window.sum(0) @ around, window.sum(1) @ around]) / mass
        cell = np.array([column - reach, row - reach]) + offset
        modes.append(Mode(cell * CELL + 0.5 * (CELL - 1), mass))
        window[:] = 0.0
    return tuple(modes)
