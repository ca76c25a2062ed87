"""What one look at an image shows of cables."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from perception.cable.types import Endpoint, Points

Shares = NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class Tangle:
    """A place where strands cross at least three times close together; it may be a knot.

    Attributes:
        centre_px: Its middle, shape (2,).
        radius_px: What lies within is part of it.
        probability: Belief that this is one.
    """

    centre_px: Points
    radius_px: float
    probability: float


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """What is seen of cables in one image.

    Attributes:
        cable: Belief that a pixel shows cable, shape (height, width).
        connector: Belief that it shows a connector or an adapter, same shape.
        width_px: Width of the cable; None where none is seen.
        endpoints: Ends of cables, the surest first; cable that leaves the view has none.
        plugged: Belief that each of them carries a connector.
        crossings_px: Where strands cross, the surest first, shape (N, 2).
        crossing_probabilities: Belief in each, shape (N,).
        tangles: Places with many crossings, the surest first.
    """

    cable: Shares
    connector: Shares
    width_px: float | None
    endpoints: tuple[Endpoint, ...]
    plugged: tuple[float, ...]
    crossings_px: Points
    crossing_probabilities: Points
    tangles: tuple[Tangle, ...]

    @property
    def cable_pixels(self) -> NDArray[np.bool_]:
        """Which pixels show cable or connector, shape (height, width)."""
        pixels: NDArray[np.bool_] = (self.cable > 0.5) | (self.connector > 0.5)
        return pixels
