"""What baselines have in common: parts see the cable, and a tracer of one's choice follows it."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from perception.cable.interfaces import CableVision, Tracer
from perception.cable.types import Endpoint, Points, Trace
from perception.camera import GreyImage


class SightOfParts:
    """The half of `CableVision` that comes before crossings.

    Args:
        parts: Sees ends and cable pixels.
        tracer: Follows the cable.
    """

    def __init__(self, parts: CableVision, tracer: Tracer) -> None:
        self._parts, self._tracer = parts, tracer

    def cable_pixels(self, image: GreyImage) -> NDArray[np.bool_]:
        """Say which pixels show cable or connector, shape (height, width)."""
        return self._parts.cable_pixels(image)

    def pieces(self, image: GreyImage) -> tuple[Points, ...]:
        """Return unbranched pieces of centre line, longest first, shape (N, 2) each."""
        return self._parts.pieces(image)

    def endpoints(self, image: GreyImage) -> tuple[Endpoint, ...]:
        """Find the ends of cables."""
        return self._parts.endpoints(image)

    def start_points(self, image: GreyImage, endpoint: Endpoint) -> Points | None:
        """Follow the cable for about 96 px from an end, shape (N, 2); None when unclear."""
        return self._parts.start_points(image, endpoint)

    def trace(
        self, image: GreyImage, start_px: Points, endpoints: Sequence[Endpoint]
    ) -> Trace | None:
        """Follow one cable; see `Tracer.trace`."""
        return self._tracer.trace(image, start_px, endpoints)

    def explained_share(self, image: GreyImage, trace: Trace) -> float:
        """Return the share of cable pixels in view that a trace accounts for, in [0, 1]."""
        return self._parts.explained_share(image, trace)
