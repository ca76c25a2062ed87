"""Several perceptions behind one interface, one of them in use; each is built when it is needed."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from executive.core.errors import InputError
from executive.core.registry import closest
from perception.cable.interfaces import CableVision
from perception.cable.types import CableScene, Coverage, Crossing, Endpoint, Knot, Points, Trace
from perception.camera import GreyImage


class SelectableVision:
    """Implements `CableVision` by the one that was selected last."""

    def __init__(self, known: Mapping[str, Callable[[], CableVision]], first: str) -> None:
        """Take perceptions by name; nothing is built yet.

        Args:
            known: How each is built.
            first: The one in use until another is selected.
        """
        self._known, self._built = known, dict[str, CableVision]()
        self._selected = first

    def select(self, name: str) -> None:
        """Look with another one from now on.

        Raises:
            InputError: It is not known, or cannot be built here.
        """
        if name not in self._known:
            raise InputError(f"vision: unknown vision {name!r}; {closest(name, [*self._known])}")
        self._build(name)
        self._selected = name

    @property
    def selected(self) -> str:
        """Name of the one in use."""
        return self._selected

    def _build(self, name: str) -> CableVision:
        if name not in self._built:
            self._built[name] = self._known[name]()
        return self._built[name]

    @property
    def _now(self) -> CableVision:
        return self._build(self._selected)

    def cable_pixels(self, image: GreyImage) -> NDArray[np.bool_]:
        """Say which pixels show cable or connector, shape (height, width)."""
        return self._now.cable_pixels(image)

    def pieces(self, image: GreyImage) -> tuple[Points, ...]:
        """Return unbranched pieces of centre line, longest first, shape (N, 2) each."""
        return self._now.pieces(image)

    def endpoints(self, image: GreyImage) -> tuple[Endpoint, ...]:
        """Find the ends of cables."""
        return self._now.endpoints(image)

    def start_points(self, image: GreyImage, endpoint: Endpoint) -> Points | None:
        """Follow the cable for about 96 px from an end, shape (N, 2); None when unclear."""
        return self._now.start_points(image, endpoint)

    def trace(
        self, image: GreyImage, start_px: Points, endpoints: Sequence[Endpoint]
    ) -> Trace | None:
        """Follow one cable; see `Tracer.trace`."""
        return self._now.trace(image, start_px, endpoints)

    def coverage(self, image: GreyImage, trace: Trace) -> Coverage:
        """Return how much of the cable in view a trace accounts for."""
        return self._now.coverage(image, trace)

    def crossings(self, image: GreyImage, traces: Sequence[Trace]) -> tuple[Crossing, ...]:
        """Classify all crossings; see `CrossingClassifier.classify`."""
        return self._now.crossings(image, traces)

    def knots(
        self, image: GreyImage, traces: Sequence[Trace], crossings: Sequence[Crossing]
    ) -> tuple[Knot, ...]:
        """Find knots and where to hold them."""
        return self._now.knots(image, traces, crossings)

    def knotted_probability(self, traces: Sequence[Trace], crossings: Sequence[Crossing]) -> float:
        """Carry the beliefs of traces and crossings to P(knotted)."""
        return self._now.knotted_probability(traces, crossings)

    def scene(self, image: GreyImage, start_px: Points | None = None) -> CableScene:
        """Do all steps on one image, from a given start or from the ends that are seen."""
        return self._now.scene(image, start_px)
