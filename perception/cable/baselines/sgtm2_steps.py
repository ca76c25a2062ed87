"""SGTM 2.0 step by step, for a robot's tree.

It knows no crossings. Each place that looks like a dense knot and that a trace runs through is
carried as one: from where the trace enters it, as if below, to where it leaves it, as if on top.
"""

from collections.abc import Sequence

import numpy as np

from perception.cable.baselines.sgtm2 import Detector, first_met
from perception.cable.baselines.sight_of_parts import SightOfParts
from perception.cable.grasp_points import GraspConfig, held_strand
from perception.cable.interfaces import CableVision, Tracer
from perception.cable.knots import grasp_policy, held_knot
from perception.cable.types import Crossing, Knot, Trace
from perception.camera import GreyImage


class Sgtm2Vision(SightOfParts):
    """Implements `CableVision` as SGTM 2.0 sees.

    Args:
        parts: Sees ends and cable pixels.
        tracer: Follows the cable.
        detector: Finds places that look like dense knots.
        grasps: The search for cage and pinch points.
    """

    def __init__(
        self,
        parts: CableVision,
        tracer: Tracer,
        detector: Detector,
        grasps: GraspConfig | None = None,
    ) -> None:
        super().__init__(parts, tracer)
        self._detector, self._grasps = detector, grasps or GraspConfig()

    def crossings(self, image: GreyImage, traces: Sequence[Trace]) -> tuple[Crossing, ...]:
        """Return for each trace the place that looks like a knot and that it comes to first."""
        tangles = self._detector(image)
        found = []
        for number, trace in enumerate(traces):
            met = first_met(trace, tangles)
            if met is not None and met[1][1] > met[1][0]:
                tangle, (enters, leaves) = met
                belief = float(np.clip(tangle.probability, 0.5, 1.0))
                found.append(Crossing(tangle.centre_px, number, leaves, number, enters, belief))
        return tuple(found)

    def knots(
        self, image: GreyImage, traces: Sequence[Trace], crossings: Sequence[Crossing]
    ) -> tuple[Knot, ...]:
        """Return these places as knots, and where to hold them."""
        del image  # The places are known already.
        policy = grasp_policy(self._grasps)
        return tuple(
            held_knot(
                policy,
                held_strand(traces, crossing.trace_over, ()),
                crossing.trace_over,
                _interval(crossing),
            )
            for crossing in crossings
        )

    def knotted_probability(self, traces: Sequence[Trace], crossings: Sequence[Crossing]) -> float:
        """Return the detector's belief in the surest place, 0 where there is none."""
        del traces
        return max((crossing.probability for crossing in crossings), default=0.0)


def _interval(crossing: Crossing) -> tuple[float, float]:
    """Return where a trace enters and leaves, whichever way round it is read."""
    return min(crossing.arc_over, crossing.arc_under), max(crossing.arc_over, crossing.arc_under)
