"""The whole of cable perception, from the image alone; learned models only where asked for."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from perception.cable.belief import knotted_probability
from perception.cable.bundles import separateness
from perception.cable.classifiers.continuity import ContinuityClassifier
from perception.cable.classifiers.edges import EdgeClassifier
from perception.cable.coverage import explained_share
from perception.cable.covered_ends import ends_are_clear
from perception.cable.crowding import doubt_shared
from perception.cable.eyes import Eye, ThresholdEye
from perception.cable.grasp_points import CablePixels, GraspConfig
from perception.cable.interfaces import CrossingClassifier, Tracer
from perception.cable.knots import find_knots
from perception.cable.tracers.analytic import AnalyticTracer
from perception.cable.tracers.skeleton import SkeletonTracer
from perception.cable.types import CableScene, Crossing, Endpoint, Knot, Points, Trace, TraceEnd
from perception.cable.wholeness import wholeness
from perception.camera import GreyImage


# Networks need the extra `learn`; who does not ask for them does without.
def _learned_eye() -> Eye:
    from perception.cable.sight.eye import SightEye
    from perception.models.store import FOLDER

    return SightEye(FOLDER / "sight_v1")


def _learned_tracer(_: Eye) -> Tracer:
    from perception.cable.tracers.both_ways import BothWaysTracer
    from perception.cable.tracers.learned import LearnedTracer
    from perception.models.store import FOLDER

    return BothWaysTracer(LearnedTracer(FOLDER / "tracer_v2"))


def _learned_classifier() -> CrossingClassifier:
    from perception.cable.classifiers.learned import LearnedClassifier
    from perception.models.store import FOLDER

    return LearnedClassifier(FOLDER / "crossing_v1")


EYES: dict[str, Callable[[], Eye]] = {"thresholds": ThresholdEye, "learned": _learned_eye}
TRACERS: dict[str, Callable[[Eye], Tracer]] = {
    "skeleton": lambda eye: SkeletonTracer(observe=eye.observe),
    "analytic": lambda eye: AnalyticTracer(observe=eye.observe),
    "learned": _learned_tracer,
}
CLASSIFIERS: dict[str, Callable[[], CrossingClassifier]] = {
    "edges": EdgeClassifier,
    "continuity": ContinuityClassifier,
    "learned": _learned_classifier,
}

# Tracers finish up to this far from an end.
REACHED_PX = 20.0
# A second point this far into the cable tells a tracer which way to go from an end.
AHEAD_PX = 4.0


@dataclass(frozen=True, slots=True)
class ClassicVisionConfig:
    """Settings of classic cable perception.

    Attributes:
        eye: What cable and ends are seen with.
        tracer: How cables are followed.
        classifier: How over and under are told apart.
        start_steps: Steps of the analytic tracer that make the start of a trace.
        hidden_rows: Lowest rows that show the robot instead of the table; they are cut off, so
            that cable which goes there leaves the view (thesis: 130).
        grasps: The search for cage and pinch points.
    """

    eye: Literal["thresholds", "learned"] = "thresholds"
    tracer: Literal["skeleton", "analytic", "learned"] = "skeleton"
    classifier: Literal["edges", "continuity", "learned"] = "edges"
    start_steps: int = 6
    hidden_rows: int = 0
    grasps: GraspConfig = field(default_factory=GraspConfig)


class ClassicCableVision:
    """Implements `CableVision` with mask, skeleton, knot theory and two kinds of evidence."""

    def __init__(self, config: ClassicVisionConfig | None = None) -> None:
        """Build the steps that the settings name."""
        self._config = config or ClassicVisionConfig()
        self._eye = EYES[self._config.eye]()
        self._tracer = TRACERS[self._config.tracer](self._eye)
        self._classifier = CLASSIFIERS[self._config.classifier]()
        self._starter = AnalyticTracer(observe=self._eye.observe)

    def cable_pixels(self, image: GreyImage) -> NDArray[np.bool_]:
        """Say which pixels show cable or connector, shape (height, width)."""
        observation = self._eye.observe(self._seen(image))
        if observation is None:
            return np.zeros(image.shape, dtype=bool)
        hidden = [(0, self._config.hidden_rows), (0, 0)]
        return np.pad(observation.mask.cable, hidden)

    def pieces(self, image: GreyImage) -> tuple[Points, ...]:
        """Return unbranched pieces of centre line, longest first, shape (N, 2) each."""
        observation = self._eye.observe(self._seen(image))
        edges = observation.graph.edges if observation is not None else ()
        ordered = sorted(edges, key=lambda edge: -edge.length_px)
        return tuple(edge.points_px for edge in ordered)

    def endpoints(self, image: GreyImage) -> tuple[Endpoint, ...]:
        """Find the ends of cables, the surest first."""
        return self._eye.endpoints(self._seen(image))

    def start_points(self, image: GreyImage, endpoint: Endpoint) -> Points | None:
        """Follow the cable for about 96 px from an end; None when other strands are too near."""
        return self._starter.steps(
            self._seen(image), endpoint.position_px, endpoint.direction, self._config.start_steps
        )

    def trace(
        self, image: GreyImage, start_px: Points, endpoints: Sequence[Endpoint]
    ) -> Trace | None:
        """Follow one cable; see `Tracer.trace`.

        A trace that claims to run from end to end and yet leaves cable out, lies upon itself so
        long that crossings hide, or crosses a connector, is not believed, however sure the
        tracer was of each step.
        """
        seen = self._seen(image)
        trace = self._tracer.trace(seen, start_px, endpoints)
        observation = self._eye.observe(seen)
        if trace is None or observation is None:
            return None
        if trace.end is not TraceEnd.ENDPOINT:
            return trace
        belief = wholeness(observation, trace.points_px) * separateness(trace.points_px)
        belief *= ends_are_clear(trace.points_px)
        return replace(trace, probability=trace.probability * belief)

    def explained_share(self, image: GreyImage, trace: Trace) -> float:
        """Return the share of cable pixels in view that a trace accounts for, in [0, 1]."""
        return explained_share(self.cable_pixels(image), trace.points_px)

    def crossings(self, image: GreyImage, traces: Sequence[Trace]) -> tuple[Crossing, ...]:
        """Classify all crossings; see `CrossingClassifier.classify`."""
        return doubt_shared(self._classifier.classify(self._seen(image), traces))

    def knots(
        self, image: GreyImage, traces: Sequence[Trace], crossings: Sequence[Crossing]
    ) -> tuple[Knot, ...]:
        """Find knots and where to hold them."""
        seen = self._eye.observe(self._seen(image))
        pixels = CablePixels(seen.mask.cable, seen.mask.width_px) if seen is not None else None
        return find_knots(traces, crossings, self._config.grasps, pixels)

    def knotted_probability(self, traces: Sequence[Trace], crossings: Sequence[Crossing]) -> float:
        """Carry the beliefs of traces and crossings to P(knotted)."""
        return knotted_probability(traces, crossings)

    def scene(self, image: GreyImage, start_px: Points | None = None) -> CableScene:
        """Do all steps on one image, from a given start or from the ends that are seen."""
        began_s = time.perf_counter()
        endpoints = self.endpoints(image)
        traces = self._traces(image, start_px, endpoints)
        crossings = self.crossings(image, traces)
        return CableScene(
            traces=traces,
            endpoints=endpoints,
            crossings=crossings,
            knots=self.knots(image, traces, crossings),
            knotted_probability=self.knotted_probability(traces, crossings),
            seconds=time.perf_counter() - began_s,
        )

    def _seen(self, image: GreyImage) -> GreyImage:
        """Return the rows that show the table."""
        return image[: len(image) - self._config.hidden_rows]

    def _traces(
        self, image: GreyImage, start_px: Points | None, endpoints: Sequence[Endpoint]
    ) -> tuple[Trace, ...]:
        """Trace from the start, or from every end that no trace has come to yet."""
        if start_px is not None:
            trace = self.trace(image, start_px, endpoints)
            return (trace,) if trace is not None else ()
        traces: list[Trace] = []
        for endpoint in endpoints:
            if any(_touches(trace, endpoint) for trace in traces):
                continue
            ahead = endpoint.position_px + AHEAD_PX * endpoint.direction
            trace = self.trace(image, np.stack([endpoint.position_px, ahead]), endpoints)
            if trace is not None:
                traces.append(trace)
        return tuple(traces)


def _touches(trace: Trace, endpoint: Endpoint) -> bool:
    """Say whether a trace starts or ends at an endpoint."""
    gaps = np.linalg.norm(trace.points_px[[0, -1]] - endpoint.position_px, axis=1)
    return bool(gaps.min() <= REACHED_PX)
