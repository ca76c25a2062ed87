"""Middles of things from heat maps."""

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.special import expit

from perception.models.sight_input import STRIDE

Floats = NDArray[np.float64]
Logits = NDArray[np.float32]


def find_peaks(heat: Logits, least: float) -> tuple[NDArray[np.int64], NDArray[np.int64], Floats]:
    """Return rows, columns and probabilities of local maxima, the surest first.

    Args:
        heat: Logits, shape (h, w).
        least: Least probability.
    """
    highest = cv2.dilate(heat, np.ones((3, 3), np.uint8))
    rows, columns = np.nonzero((heat == highest) & (heat > np.log(least / (1.0 - least))))
    order = np.argsort(-heat[rows, columns], kind="stable")
    rows, columns = rows[order], columns[order]
    return rows, columns, expit(heat[rows, columns].astype(float))


def apart(places_px: Floats, least_px: float) -> list[int]:
    """Return which places, in order, have none before them nearer than `least_px`."""
    kept: list[int] = []
    for k, place in enumerate(places_px):
        if all(float(np.hypot(*(place - places_px[other]))) >= least_px for other in kept):
            kept.append(k)
    return kept


def cell_middle(columns: NDArray[np.int64], rows: NDArray[np.int64]) -> Floats:
    """Return the middles of cells [px], shape (N, 2)."""
    middles = (np.column_stack([columns, rows]).astype(float) + 0.5) * STRIDE - 0.5
    return np.asarray(middles, dtype=float)
