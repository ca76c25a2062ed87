"""Spatial occupancy in the image: the thesis's heuristic, and the minimum over time."""

from collections.abc import Sequence

import numpy as np

from perception.shelf.types import Floats, Sighting


def mask_occupancy(seen: Sequence[Sighting], shape: tuple[int, int]) -> Floats:
    """Return 1 where any object is seen, 0 elsewhere.

    The geometric heuristic of the thesis (section 7.5): the OR of all segmentation masks; added up
    along the image's columns it is the distribution along the shelf.

    Args:
        seen: What is in view.
        shape: Height and width of the image.
    """
    occupancy = np.zeros(shape)
    for sighting in seen:
        occupancy[sighting.mask] = 1.0
    return occupancy


def along_shelf(occupancy: Floats) -> Floats:
    """Return the distribution along the shelf, the same in every row of the image.

    LAX-RAY and the thesis work on this one: only x matters to a push along the shelf.

    Args:
        occupancy: Shape (height, width).
    """
    columns = occupancy.mean(axis=0, keepdims=True)
    return np.broadcast_to(columns, occupancy.shape)


class RunningMinimum:
    """Keeps the least occupancy that each pixel has had (thesis, section 5.1, after LAX-RAY)."""

    def __init__(self) -> None:
        """Begin without any."""
        self._least: Floats | None = None

    def update(self, occupancy: Floats) -> Floats:
        """Take the next occupancy in, and return the minimum so far, same shape."""
        self._least = occupancy if self._least is None else np.minimum(self._least, occupancy)
        return self._least
