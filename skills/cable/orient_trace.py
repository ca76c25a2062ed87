"""Read the cable from the end that is nearer to a knot."""

from collections.abc import Sequence
from typing import Annotated

from executive.core.outcome import success
from executive.core.skill import In, Port, Skill, SkillRun
from perception.cable.interfaces import CableVision
from perception.cable.orientation import reversed_crossings, reversed_trace
from perception.cable.types import Crossing, Trace
from perception.camera import CameraFrame


class OrientTrace(Skill):
    """Turn a trace round when its first knot is nearer to the other end.

    A dilation draws the tail before the first knot out of it, so the shorter tail is done first.

    SUCCESS: `trace` and `crossings` describe the same cable, from the better end; without a
        knot they are what came in.
    """

    OUT = {
        "trace": Port(Trace, "path of the cable from the better end"),
        "crossings": Port(tuple[Crossing, ...], "its crossings"),
    }

    def __init__(self, vision: CableVision) -> None:
        """Bind perception."""
        self._vision = vision

    def run(
        self,
        frame: Annotated[CameraFrame, In("overhead frame")],
        trace: Annotated[Trace, In("path of the cable")],
        crossings: Annotated[tuple[Crossing, ...], In("crossings of the trace")],
    ) -> SkillRun:
        """Compare the tails before the first knot, read from both ends."""
        turned = reversed_trace(trace), reversed_crossings(crossings)
        tail = self._tail(frame, trace, crossings)
        yield
        if self._tail(frame, *turned) < tail:
            trace, crossings = turned
        return success(trace=trace, crossings=crossings)

    def _tail(self, frame: CameraFrame, trace: Trace, crossings: Sequence[Crossing]) -> float:
        """Return the share of the cable before the first knot, 1 when there is none."""
        knots = self._vision.knots(frame.image, (trace,), crossings)
        return knots[0].interval[0] if knots else 1.0
