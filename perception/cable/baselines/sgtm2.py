"""SGTM 2.0 (K. Shivakumar et al. 2022), as far as the thesis compares with it.

An analytic tracer follows the cable from one end, and a detector that was trained on dense
knots says where in the image one lies. The first of these that the trace comes to is the knot;
there is no over and under, and nothing is known about how the cable runs inside.
"""

import time
from collections.abc import Callable, Sequence

import numpy as np

from perception.cable.baselines.one_trace import first_trace
from perception.cable.grasp_points import GraspConfig, held_strand
from perception.cable.interfaces import CableVision, Tracer
from perception.cable.knots import grasp_policy, held_knot
from perception.cable.polyline import arc_lengths, resample
from perception.cable.sight.seen import Tangle
from perception.cable.types import CableScene, Knot, Trace
from perception.camera import GreyImage

# Finds places in an image that look like dense knots.
Detector = Callable[[GreyImage], Sequence[Tangle]]


class Sgtm2:
    """Sees knots as SGTM 2.0 does.

    Args:
        parts: Sees ends.
        tracer: Follows the cable.
        detector: Finds knots.
        grasps: The search for cage and pinch points.
    """

    def __init__(
        self,
        parts: CableVision,
        tracer: Tracer,
        detector: Detector,
        grasps: GraspConfig | None = None,
    ) -> None:
        self._parts, self._tracer, self._detector = parts, tracer, detector
        self._grasps = grasps or GraspConfig()

    def scene(self, image: GreyImage) -> CableScene:
        """Do all steps on one image; the belief is the detector's in the first knot."""
        began_s = time.perf_counter()
        endpoints = self._parts.endpoints(image)
        traces = first_trace(self._parts, self._tracer, image, endpoints)
        tangles = self._detector(image)
        met = first_met(traces[0], tangles) if traces else None
        knots: tuple[Knot, ...] = ()
        if met is not None:
            strand = held_strand(traces, 0, ())
            knots = (held_knot(grasp_policy(self._grasps), strand, 0, met[1]),)
        return CableScene(
            traces=traces,
            endpoints=endpoints,
            crossings=(),
            knots=knots,
            knotted_probability=met[0].probability if met is not None else 0.0,
            seconds=time.perf_counter() - began_s,
        )


def first_met(trace: Trace, tangles: Sequence[Tangle]) -> tuple[Tangle, tuple[float, float]] | None:
    """Return the place that a trace comes to first, and where on the trace it enters and leaves.

    Returns:
        The place, and arc positions of the first and the last point in it; None for none.
    """
    line = resample(trace.points_px)
    arcs = arc_lengths(line) / max(float(arc_lengths(line)[-1]), 1e-9)
    met = []
    for number, tangle in enumerate(tangles):
        inside = np.linalg.norm(line - tangle.centre_px, axis=1) <= tangle.radius_px
        if inside.any():
            low, high = np.flatnonzero(inside)[[0, -1]]
            met.append((float(arcs[low]), float(arcs[high]), number))
    if not met:
        return None
    low_arc, high_arc, number = min(met)
    return tangles[number], (low_arc, high_arc)
