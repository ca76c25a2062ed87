"""TUSK, the thesis's perception (V. Viswanath, chapter 3), built anew from its description.

One trace from one end, over and under at each crossing, Reidemeister moves I and II, and the
knot rule. Which tracer, and whether crossings are cancelled, can be chosen: with the analytic
tracer, or without cancelling, it is one of the thesis's ablations.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

from perception.cable.baselines.sight_of_parts import SightOfParts
from perception.cable.grasp_points import CablePixels, GraspConfig, held_strand
from perception.cable.interfaces import CableVision, CrossingClassifier, Tracer
from perception.cable.knots import grasp_policy, held_knot, visits_of
from perception.cable.topology.rule import Visit, knot_intervals, uncancelled_intervals
from perception.cable.types import Crossing, Knot, Trace, TraceEnd
from perception.cable.width import width_under
from perception.camera import GreyImage

NOTHING_KNOWN = 0.5


@dataclass(frozen=True, slots=True)
class TuskConfig:
    """Settings of TUSK.

    Attributes:
        cancel: Whether crossings are cancelled before the knot rule is asked.
        grasps: The search for cage and pinch points.
    """

    cancel: bool = True
    grasps: GraspConfig = field(default_factory=lambda: GraspConfig(policy="tusk"))


class TuskVision(SightOfParts):
    """Implements `CableVision` as the thesis does.

    Args:
        parts: Sees ends and cable pixels, which the thesis leaves to a detector of its own.
        tracer: Follows the cable.
        classifier: Tells over from under.
        config: Settings.
    """

    def __init__(
        self,
        parts: CableVision,
        tracer: Tracer,
        classifier: CrossingClassifier,
        config: TuskConfig | None = None,
    ) -> None:
        super().__init__(parts, tracer)
        self._classifier, self._config = classifier, config or TuskConfig()

    def crossings(self, image: GreyImage, traces: Sequence[Trace]) -> tuple[Crossing, ...]:
        """Classify all crossings; see `CrossingClassifier.classify`."""
        return self._classifier.classify(image, traces)

    def knots(
        self, image: GreyImage, traces: Sequence[Trace], crossings: Sequence[Crossing]
    ) -> tuple[Knot, ...]:
        """Find what the rule takes for knots, and where to hold them."""
        if not traces:
            return ()
        width_px = width_under(image, [trace.points_px for trace in traces])
        policy = grasp_policy(self._config.grasps, CablePixels(self.cable_pixels(image), width_px))
        return tuple(
            held_knot(policy, held_strand(traces, k, crossings), k, (begin.arc, close.arc))
            for k in range(len(traces))
            for begin, close, _ in self._potential_knots(k, crossings)
        )

    def knotted_probability(self, traces: Sequence[Trace], crossings: Sequence[Crossing]) -> float:
        """Return the confidence of the surest knot, 0 where a whole trace shows none.

        The thesis gives each knot a confidence, those of its first and its last crossing
        multiplied; it is no probability, and nothing is said of cables without a knot.
        """
        sure = [c for k in range(len(traces)) for *_, c in self._potential_knots(k, crossings)]
        whole = any(trace.end is TraceEnd.ENDPOINT for trace in traces)
        return max(sure, default=0.0 if whole else NOTHING_KNOWN)

    def _potential_knots(
        self, index: int, crossings: Sequence[Crossing]
    ) -> list[tuple[Visit, Visit, float]]:
        """Return first and last visit of each potential knot of a trace, and its confidence."""
        own = [c for c in crossings if c.trace_over == index and c.trace_under == index]
        visits = visits_of(own)
        found = knot_intervals(visits) if self._config.cancel else uncancelled_intervals(visits)
        # Both visits are of one crossing; each has the confidence that the crossing has.
        return [(begin, close, own[begin.crossing].probability ** 2) for begin, close in found]
