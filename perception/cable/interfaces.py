"""The steps of cable perception as interfaces; each has more than one implementation."""

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from perception.cable.types import (
    CableScene,
    Coverage,
    Crossing,
    Endpoint,
    ImaginedHand,
    Knot,
    Points,
    Trace,
)
from perception.camera import GreyImage


@runtime_checkable
class Tracer(Protocol):
    """Follows one cable from a start."""

    def trace(
        self,
        image: GreyImage,
        start_px: Points,
        endpoints: Sequence[Endpoint],
    ) -> Trace | None:
        """Follow the cable that starts at `start_px`.

        Args:
            image: Grey image.
            start_px: First points, in order, shape (N, 2) with N >= 1; one point is an end
                of the cable, more points also give its direction.
            endpoints: Ends where a trace may finish.

        Returns:
            The trace, or None where there is no cable at the start.
        """
        ...


@runtime_checkable
class HypothesisTracer(Tracer, Protocol):
    """A tracer that knows of several ways a cable may go."""

    def hypotheses(
        self,
        image: GreyImage,
        start_px: Points,
        endpoints: Sequence[Endpoint],
    ) -> tuple[Trace, ...]:
        """Return distinct traces, likeliest first; their beliefs add up to 1 at most.

        Args:
            image: Grey image.
            start_px: First points; see `Tracer.trace`.
            endpoints: Ends where a trace may finish.
        """
        ...


@runtime_checkable
class CrossingClassifier(Protocol):
    """Says which strand lies on top where traces meet."""

    def classify(self, image: GreyImage, traces: Sequence[Trace]) -> tuple[Crossing, ...]:
        """Return every crossing of the traces, with its over/under belief."""
        ...


@runtime_checkable
class TraceDoubter(Protocol):
    """A classifier that sees where traces go over from one strand to another."""

    def doubted(self, image: GreyImage, traces: Sequence[Trace]) -> tuple[Trace, ...]:
        """Return ways to trace one cable, likeliest first, each believed less by what is seen.

        Args:
            image: Grey image.
            traces: The ways; their beliefs add up to 1 at most.
        """
        ...


@runtime_checkable
class CableVision(Protocol):
    """The whole of cable perception as the skills of a tree use it, step by step."""

    def cable_pixels(self, image: GreyImage) -> NDArray[np.bool_]:
        """Say which pixels show cable or connector, shape (height, width)."""
        ...

    def pieces(self, image: GreyImage) -> tuple[Points, ...]:
        """Return unbranched pieces of centre line, longest first, shape (N, 2) each.

        They need no start and no end, so they are what is left to hold when tracing fails.
        """
        ...

    def endpoints(self, image: GreyImage) -> tuple[Endpoint, ...]:
        """Find the ends of cables."""
        ...

    def start_points(self, image: GreyImage, endpoint: Endpoint) -> Points | None:
        """Follow the cable for about 96 px from an end, shape (N, 2); None when unclear."""
        ...

    def trace(
        self, image: GreyImage, start_px: Points, endpoints: Sequence[Endpoint]
    ) -> Trace | None:
        """Follow one cable; see `Tracer.trace`."""
        ...

    def coverage(self, image: GreyImage, trace: Trace) -> Coverage:
        """Return how much of the cable in view a trace accounts for."""
        ...

    def crossings(self, image: GreyImage, traces: Sequence[Trace]) -> tuple[Crossing, ...]:
        """Classify all crossings; see `CrossingClassifier.classify`."""
        ...

    def knots(
        self, image: GreyImage, traces: Sequence[Trace], crossings: Sequence[Crossing]
    ) -> tuple[Knot, ...]:
        """Find knots and where to hold them."""
        ...

    def knotted_probability(self, traces: Sequence[Trace], crossings: Sequence[Crossing]) -> float:
        """Carry the beliefs of traces and crossings to P(knotted)."""
        ...

    def scene(self, image: GreyImage, start_px: Points | None = None) -> CableScene:
        """Do all steps on one image, from a given start or from the ends that are seen."""
        ...


@runtime_checkable
class Foresight(Protocol):
    """Imagines what hands would do to a cable."""

    def after(
        self, line_m: Points, over: Sequence[float], hands: Sequence[ImaginedHand]
    ) -> Points | None:
        """Return how the cable should lie after hands have carried it and laid it down.

        Args:
            line_m: The cable on the table, shape (N, 2).
            over: Arc positions where it is believed to lie on top of another strand.
            hands: What they do; they move in step.

        Returns:
            Points along the cable, shape (M, 3); None where a hand would miss it.
        """
        ...
