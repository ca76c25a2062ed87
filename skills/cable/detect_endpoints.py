"""Find the ends of the cable."""

from typing import Annotated

from executive.core.outcome import failure, success
from executive.core.skill import In, Port, Skill, SkillRun
from executive.core.work import Worker
from perception.cable.interfaces import CableVision
from perception.cable.types import Endpoint
from perception.camera import CameraFrame


class DetectEndpoints(Skill):
    """Find the ends of the cable in a frame, surest first.

    SUCCESS: at least one end is seen.
    FAILURE: `endpoints.none` when no end is visible.
    """

    OUT = {"endpoints": Port(tuple[Endpoint, ...], "ends of the cable, surest first")}
    REASONS = frozenset({"endpoints.none"})

    def __init__(self, vision: CableVision, worker: Worker) -> None:
        """Bind perception, and who has the time for it."""
        self._vision, self._worker = vision, worker

    def run(self, frame: Annotated[CameraFrame, In("overhead frame")]) -> SkillRun:
        """Detect and sort."""
        found = yield from self._worker.run(self._vision.endpoints, frame.image)
        if not found:
            return failure("endpoints.none", "no end of the cable is visible")
        return success(endpoints=tuple(sorted(found, key=lambda end: -end.probability)))
