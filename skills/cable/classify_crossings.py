"""Say which strand lies on top where the cable crosses itself."""

from typing import Annotated

from executive.core.outcome import success
from executive.core.skill import In, Port, Skill, SkillRun
from executive.core.work import Worker
from perception.cable.interfaces import CableVision
from perception.cable.types import Crossing, Trace
from perception.camera import CameraFrame


class ClassifyCrossings(Skill):
    """Find the crossings of a trace and classify over and under.

    SUCCESS: `crossings` has every crossing with its probability; it may be empty.
    """

    OUT = {"crossings": Port(tuple[Crossing, ...], "crossings in the order of the trace")}

    def __init__(self, vision: CableVision, worker: Worker) -> None:
        """Bind perception, and who has the time for it."""
        self._vision, self._worker = vision, worker

    def run(
        self,
        frame: Annotated[CameraFrame, In("overhead frame")],
        trace: Annotated[Trace, In("path of the cable")],
    ) -> SkillRun:
        """Classify."""
        crossings = yield from self._worker.run(self._vision.crossings, frame.image, (trace,))
        return success(crossings=crossings)
