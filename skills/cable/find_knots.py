"""Find the knots of a traced cable and how likely it is that there are any."""

from typing import Annotated

from executive.core.outcome import success
from executive.core.skill import In, Port, Skill, SkillRun
from executive.core.work import Worker
from perception.cable.interfaces import CableVision
from perception.cable.types import Crossing, Endpoint, Knot, Trace
from perception.camera import CameraFrame
from skills.cable.connectors import through_connectors

_Reading = tuple[Trace, tuple[Crossing, ...]]


class FindKnots(Skill):
    """Analyse the topology of a trace.

    A strand across a connector is a crossing that no trace shows, and that may make the knot.

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
        endpoints: Annotated[tuple[Endpoint, ...], In("ends of the cable")] = (),
        doubt_connectors: Annotated[bool, In("count strands that lie across connectors")] = False,
    ) -> SkillRun:
        """Simplify the diagram, find knots, carry probabilities through."""
        counted = (trace, crossings)
        if doubt_connectors:
            counted = through_connectors(trace, crossings, endpoints)
        knots, probability = yield from self._worker.run(
            self._analysed, frame, (trace, crossings), counted
        )
        return success(knots=knots, knotted_probability=probability)

    def _analysed(
        self, frame: CameraFrame, seen: _Reading, counted: _Reading
    ) -> tuple[tuple[Knot, ...], float]:
        """Return knots where they are seen, and the belief in any with all that counts."""
        knots = self._vision.knots(frame.image, (seen[0],), seen[1])
        return knots, self._vision.knotted_probability((counted[0],), counted[1])
