"""Say which strand lies on top where the cable crosses itself."""

from typing import Annotated

from executive.core.outcome import success
from executive.core.skill import In, Port, Skill, SkillRun
from perception.cable.interfaces import CableVision
from perception.cable.types import Crossing, Trace
from perception.camera import CameraFrame


class ClassifyCrossings(Skill):
    """Find the crossings of a trace and classify over and under.

    SUCCESS: `crossings` has every crossing with its probability; it may be empty.
    """

    OUT = {"crossings": Port(tuple[Crossing, ...], "crossings in the order of the trace")}

    def __init__(self, vision: CableVision) -> None:
        """Bind perception."""
        self._vision = vision

    def run(
        self,
        frame: Annotated[CameraFrame, In("overhead frame")],
        trace: Annotated[Trace, In("path of the cable")],
    ) -> SkillRun:
        """Classify."""
        crossings = self._vision.crossings(frame.image, (trace,))
        yield
        return success(crossings=crossings)
