"""Find the knots of a traced cable and how likely it is that there are any."""

from typing import Annotated

from executive.core.outcome import success
from executive.core.skill import In, Port, Skill, SkillRun
from executive.core.work import Worker
from perception.cable.interfaces import CableVision
from perception.cable.types import Crossing, Knot, Trace
from perception.camera import CameraFrame


class FindKnots(Skill):
    """Analyse the topology of a trace.

    SUCCESS: `knots` in the order of the trace, maybe none, and P(knotted).
    """

    OUT = {
        "knots": Port(tuple[Knot, ...], "knots in the order of the trace"),
        "knotted_probability": Port(float, "belief that the cable is knotted"),
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
        """Simplify the diagram, find knots, carry probabilities through."""
        knots = yield from self._worker.run(self._vision.knots, frame.image, (trace,), crossings)
        probability = self._vision.knotted_probability((trace,), crossings)
        return success(knots=knots, knotted_probability=probability)
