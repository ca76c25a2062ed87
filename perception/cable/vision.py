"""The whole of cable perception, from the grey image alone."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from perception.cable.belief import any_knotted, knot_types, knotted_probability, reading_of
from perception.cable.coverage import coverage_of
from perception.cable.crowding import doubt_shared
from perception.cable.eyes import LEAST_END, EndJudge
from perception.cable.grasp_points import GraspConfig
from perception.cable.interfaces import HypothesisTracer, TraceDoubter
from perception.cable.knots import find_knots
from perception.cable.left_over import doubt_left_over
from perception.cable.parts import (
    CLASSIFIERS,
    EYES,
    TRACERS,
    ClassifierName,
    EyeName,
    TracerName,
)
from perception.cable.polyline import arc_lengths, resample
from perception.cable.telling import telling_question
from perception.cable.tracers.analytic import AnalyticTracer
from perception.cable.types import (
    CableScene,
    Coverage,
    Crossing,
    Endpoint,
    Knot,
    Points,
    Reading,
    Trace,
    TraceEnd,
    TraceStart,
)
from perception.camera import GreyImage

# Tracers finish up to this far from an end.
REACHED_PX = 20.0
# A trace runs through an end that lies this near to it.
THROUGH_PX = 4.0
# A trace of which more than this share lies on another one follows the same cable.
SAME_CABLE = 0.5
# Where a trace is believed in less, the same cable is traced from its other end, too.
BELIEVED = 0.5
# Other ways to read a cable than the likeliest are weighed down to this belief, so many at most.
LEAST_READING, MOST_READINGS = 0.02, 4


@dataclass(frozen=True, slots=True)
class VisionConfig:
    """Settings of cable perception.

    Attributes:
        eye: What cable and ends are seen with.
        tracer: How cables are followed.
        classifier: How over and under are told apart.
        start_steps: Steps of the analytic tracer that make the start of a trace.
        hidden_rows: Lowest rows that show the robot instead of the table; they are cut off, so
            that cable which goes there leaves the view (thesis: 130).
        grasps: The search for cage and pinch points.
    """

    eye: EyeName = "thresholds"
    tracer: TracerName = "skeleton"
    classifier: ClassifierName = "edges"
    start_steps: int = 6
    hidden_rows: int = 0
    grasps: GraspConfig = field(default_factory=GraspConfig)


# What sees cables of any look on any table; without it, bright cables on dark cloth are seen.
LEARNED = VisionConfig(eye="learned", tracer="learned", classifier="learned")


class GreyImageVision:
    """Implements `CableVision` with an eye, a tracer, a classifier and knot theory."""

    def __init__(self, config: VisionConfig | None = None) -> None:
        """Build the parts that the settings name."""
        self._config = config or VisionConfig()
        self._eye = EYES[self._config.eye]()
        self._tracer = TRACERS[self._config.tracer](self._eye)
        self._classifier = CLASSIFIERS[self._config.classifier](self._eye)
        self._starter = AnalyticTracer(observe=self._eye.observe)
        # Steps of perception ask one after the other about the same image.
        self._ended = lru_cache(maxsize=2)(self._find_ends)

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
        seen = self._seen(image)
        return self._ended(seen.tobytes(), seen.shape)

    def start_points(self, image: GreyImage, endpoint: Endpoint) -> Points | None:
        """Follow the cable for about 96 px from an end; None when other strands are too near."""
        return self._starter.steps(
            self._seen(image), endpoint.position_px, endpoint.direction, self._config.start_steps
        )

    def trace(
        self, image: GreyImage, start_px: Points, endpoints: Sequence[Endpoint]
    ) -> Trace | None:
        """Follow one cable; see `Tracer.trace`."""
        return next(iter(self._ways(image, start_px, endpoints)), None)

    def coverage(self, image: GreyImage, trace: Trace) -> Coverage:
        """Return how much of the cable in view a trace accounts for."""
        return coverage_of(self.cable_pixels(image), trace.points_px)

    def crossings(self, image: GreyImage, traces: Sequence[Trace]) -> tuple[Crossing, ...]:
        """Classify all crossings; see `CrossingClassifier.classify`."""
        return doubt_shared(self._classifier.classify(self._seen(image), traces))

    def knots(
        self, image: GreyImage, traces: Sequence[Trace], crossings: Sequence[Crossing]
    ) -> tuple[Knot, ...]:
        """Find knots and where to hold them."""
        del image  # Grasp points follow from the traces alone.
        return find_knots(traces, crossings, self._config.grasps)

    def knotted_probability(self, traces: Sequence[Trace], crossings: Sequence[Crossing]) -> float:
        """Carry the beliefs of traces and crossings to P(knotted)."""
        return knotted_probability(traces, crossings)

    def scene(self, image: GreyImage, start_px: Points | None = None) -> CableScene:
        """Do all steps on one image, from a given start or from the ends that are seen."""
        began_s = time.perf_counter()
        endpoints = self.endpoints(image)
        cables = self._cables(image, start_px, endpoints)
        traces = tuple(ways[0] for ways in cables)
        crossings = self.crossings(image, traces)
        readings = [self._readings(image, k, ways, crossings) for k, ways in enumerate(cables)]
        return CableScene(
            traces=traces,
            endpoints=endpoints,
            crossings=crossings,
            knots=self.knots(image, traces, crossings),
            knotted_probability=any_knotted(readings),
            seconds=time.perf_counter() - began_s,
            knot_types=knot_types(readings[0]) if readings else (),
            telling=telling_question(readings[0]) if readings else None,
        )

    def _seen(self, image: GreyImage) -> GreyImage:
        """Return the rows that show the table."""
        return image[: len(image) - self._config.hidden_rows]

    def _find_ends(self, pixels: bytes, shape: tuple[int, ...]) -> tuple[Endpoint, ...]:
        """Return the ends that are seen, but none where the tracer sees the cable go on."""
        image = np.frombuffer(pixels, dtype=np.uint8).reshape(shape)
        ends = self._eye.endpoints(image)
        if not isinstance(self._tracer, EndJudge):
            return ends
        judged = self._tracer.judged(image, ends)
        return tuple(end for end in judged if end.probability >= LEAST_END)

    def _cables(
        self, image: GreyImage, start_px: Points | None, endpoints: Sequence[Endpoint]
    ) -> list[tuple[Trace, ...]]:
        """Return the ways to trace each cable, from the start or from every end not come to."""
        if start_px is not None:
            ways = self._ways(image, start_px, endpoints)
            return [ways] if ways else []
        cables = self._from_ends(image, endpoints)
        shared = _shared_end(cables, endpoints)
        if shared is not None:
            # One cable ends there at most, so that one may be none.
            rest = self._from_ends(image, tuple(end for end in endpoints if end is not shared))
            cables = rest if any(_joins(ways[0]) for ways in rest) else cables
        observation = self._eye.observe(self._seen(image))
        return doubt_left_over(observation, cables) if observation is not None else cables

    def _from_ends(
        self, image: GreyImage, endpoints: Sequence[Endpoint]
    ) -> list[tuple[Trace, ...]]:
        """Return the ways to trace each cable from every end not come to."""
        cables: list[tuple[Trace, ...]] = []
        for endpoint in endpoints:
            if any(_accounts_for(ways[0], endpoint) for ways in cables if _is_believed(ways[0])):
                continue
            ways = self._ways(image, TraceStart.at(endpoint).points_px, endpoints)
            if ways:
                cables.append(ways)
        return _distinct(cables)

    def _ways(
        self, image: GreyImage, start_px: Points, endpoints: Sequence[Endpoint]
    ) -> tuple[Trace, ...]:
        """Return the ways to trace the cable at a start, the likeliest first.

        Whoever looks at their crossings may see that some of them change strands.
        """
        seen = self._seen(image)
        if isinstance(self._tracer, HypothesisTracer):
            ways = self._tracer.hypotheses(seen, start_px, endpoints)
        else:
            trace = self._tracer.trace(seen, start_px, endpoints)
            ways = (trace,) if trace is not None else ()
        if isinstance(self._classifier, TraceDoubter):
            return self._classifier.doubted(seen, ways)
        return ways

    def _readings(
        self,
        image: GreyImage,
        number: int,
        ways: Sequence[Trace],
        crossings: Sequence[Crossing],
    ) -> list[Reading]:
        """Return the readings of one cable, its likeliest way with the crossings that it has."""
        others = [way for way in ways[1:MOST_READINGS] if way.probability >= LEAST_READING]
        return [
            reading_of(ways[0], number, crossings),
            *(reading_of(way, 0, self.crossings(image, [way])) for way in others),
        ]


def _distinct(cables: Sequence[tuple[Trace, ...]]) -> list[tuple[Trace, ...]]:
    """Return each cable once, the longest first; one seen from two of its ends may come twice."""
    kept: list[tuple[Trace, ...]] = []
    for ways in sorted(cables, key=lambda ways: -ways[0].probability * _length_px(ways[0])):
        if not any(_are_one(ways[0], other[0]) for other in kept):
            kept.append(ways)
    return sorted(kept, key=lambda ways: -_length_px(ways[0]))


def _length_px(trace: Trace) -> float:
    return float(arc_lengths(trace.points_px)[-1])


def _is_believed(trace: Trace) -> bool:
    """Say whether a trace is believed in enough not to ask from its other end as well."""
    return trace.probability >= BELIEVED


def _joins(trace: Trace) -> bool:
    """Say whether a trace is believed to lead from one end to another."""
    return trace.end is TraceEnd.ENDPOINT and _is_believed(trace)


def _shared_end(
    cables: Sequence[tuple[Trace, ...]], endpoints: Sequence[Endpoint]
) -> Endpoint | None:
    """Return the least sure end that traces of two cables have come to, None without one.

    A tight knot may be taken for an end, and the cable then comes there from both sides.
    """
    last_px = [ways[0].points_px[-1] for ways in cables if _joins(ways[0])]
    shared = [
        end
        for end in endpoints
        if sum(float(np.linalg.norm(at - end.position_px)) <= REACHED_PX for at in last_px) > 1
    ]
    return min(shared, key=lambda end: end.probability, default=None)


def _are_one(trace: Trace, other: Trace) -> bool:
    """Say whether two traces follow the same cable: they join the same ends, or share a way."""
    here, there = trace.points_px[[0, -1]], other.points_px[[0, -1]]
    gaps_px = [np.linalg.norm(here - ends, axis=1).max() for ends in (there, there[::-1])]
    joined = {trace.end, other.end} == {TraceEnd.ENDPOINT} and min(gaps_px) <= REACHED_PX
    return joined or _runs_along(trace, other)


def _runs_along(trace: Trace, other: Trace) -> bool:
    """Say whether a trace lies on another one for the most of its length."""
    points, line = (resample(each.points_px, THROUGH_PX) for each in (trace, other))
    gaps = np.linalg.norm(points[:, None] - line[None], axis=2).min(axis=1)
    return float((gaps <= THROUGH_PX).mean()) > SAME_CABLE


def _accounts_for(trace: Trace, endpoint: Endpoint) -> bool:
    """Say whether a trace starts or ends at an endpoint, or runs through a doubtful one."""
    if np.linalg.norm(trace.points_px[[0, -1]] - endpoint.position_px, axis=1).min() <= REACHED_PX:
        return True
    through_px = np.linalg.norm(
        resample(trace.points_px, THROUGH_PX) - endpoint.position_px, axis=1
    ).min()
    return bool(through_px <= THROUGH_PX and endpoint.probability < trace.probability)
