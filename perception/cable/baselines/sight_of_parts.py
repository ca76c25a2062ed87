"""What baselines have in common: parts see the cable, and a tracer of one's choice follows it."""

import time
from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from perception.cable.baselines.one_trace import first_trace
from perception.cable.interfaces import CableVision, Tracer
from perception.cable.types import CableScene, Coverage, Crossing, Endpoint, Knot, Points, Trace
from perception.camera import GreyImage


class SightOfParts(ABC):
    """All of `CableVision` but what a baseline makes of crossings.

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

    def coverage(self, image: GreyImage, trace: Trace) -> Coverage:
        """Return how much of the cable in view a trace accounts for."""
        return self._parts.coverage(image, trace)

    @abstractmethod
    def crossings(self, image: GreyImage, traces: Sequence[Trace]) -> tuple[Crossing, ...]:
        """Return where traces cross; see `CableVision.crossings`."""

    @abstractmethod
    def knots(
        self, image: GreyImage, traces: Sequence[Trace], crossings: Sequence[Crossing]
    ) -> tuple[Knot, ...]:
        """Return what is taken for knots, and where to hold them."""

    @abstractmethod
    def knotted_probability(self, traces: Sequence[Trace], crossings: Sequence[Crossing]) -> float:
        """Return the belief that the cable is knotted, in [0, 1]."""

    def scene(self, image: GreyImage, start_px: Points | None = None) -> CableScene:
        """Do all steps on one image, from a given start or from the first end that is clear."""
        began_s = time.perf_counter()
        endpoints = self.endpoints(image)
        if start_px is None:
            traces = first_trace(self._parts, self._tracer, image, endpoints)
        else:
            trace = self.trace(image, start_px, endpoints)
            traces = () if trace is None else (trace,)
        crossings = self.crossings(image, traces)
        return CableScene(
            traces=traces,
            endpoints=endpoints,
            crossings=crossings,
            knots=self.knots(image, traces, crossings),
            knotted_probability=self.knotted_probability(traces, crossings),
            seconds=time.perf_counter() - began_s,
        )
