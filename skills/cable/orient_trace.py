"""Read the cable from the end that is nearer to a knot."""

from collections.abc import Sequence
from typing import Annotated

from executive.core.outcome import success
from executive.core.skill import In, Port, Skill, SkillRun
from executive.core.work import Worker
from perception.cable.interfaces import CableVision
from perception.cable.orientation import reversed_crossings, reversed_trace
from perception.cable.types import Crossing, Trace
from perception.camera import CameraFrame

_Reading = tuple[Trace, Sequence[Crossing]]


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

    def __init__(self, vision: CableVision, worker: Worker) -> None:
        """Bind perception, and who has the time for it."""
        self._vision, self._worker = vision, worker

    def run(
        self,
        frame: Annotated[CameraFrame, In("overhead frame")],
        trace: Annotated[Trace, In("path of the cable")],
        crossings: Annotated[tuple[Crossing, ...], In("crossings of the trace")],
    ) -> SkillRun:
        """Compare the tails before the first knot, read from both ends."""
        turned = reversed_trace(trace), reversed_crossings(crossings)
        is_better = yield from self._worker.run(self._shorter, frame, turned, (trace, crossings))
        if is_better:
            trace, crossings = turned
        return success(trace=trace, crossings=crossings)

    def _shorter(self, frame: CameraFrame, one: _Reading, other: _Reading) -> bool:
        """Return whether the first knot comes sooner in one reading than in the other."""
        return self._tail(frame, *one) < self._tail(frame, *other)

    def _tail(self, frame: CameraFrame, trace: Trace, crossings: Sequence[Crossing]) -> float:
        """Return the share of the cable before the first knot, 1 when there is none."""
        knots = self._vision.knots(frame.image, (trace,), crossings)
        return knots[0].interval[0] if knots else 1.0
