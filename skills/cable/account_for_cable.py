"""Make sure that a trace leaves no cable out before anything is claimed about it."""

from typing import Annotated

from executive.core.outcome import failure, success
from executive.core.skill import In, Port, Skill, SkillRun
from executive.core.work import Worker
from perception.cable.interfaces import CableVision
from perception.cable.types import Trace
from perception.camera import CameraFrame
from skills.cable.connectors import with_connectors


class AccountForCable(Skill):
    """Compare a trace with all the cable that is in view.

    SUCCESS: the trace accounts for at least `share` of the cable pixels.
    FAILURE: `cable.unexplained` when more of the cable is left over: the trace took a
        short cut, or there is another cable.
    """

    OUT = {"explained": Port(float, "share of the cable in view that the trace accounts for")}
    REASONS = frozenset({"cable.unexplained"})

    def __init__(self, vision: CableVision, worker: Worker) -> None:
        """Bind perception, and who has the time for it."""
        self._vision, self._worker = vision, worker

    def run(
        self,
        frame: Annotated[CameraFrame, In("overhead frame")],
        trace: Annotated[Trace, In("path of the cable")],
        share: Annotated[float, In("share that must be accounted for")] = 0.96,
    ) -> SkillRun:
        """Count cable pixels near the trace and away from it."""
        whole = with_connectors(trace)
        explained = yield from self._worker.run(self._vision.explained_share, frame.image, whole)
        if explained < share:
            text = f"the trace accounts for {explained:.0%} of the cable in view"
            return failure("cable.unexplained", text, explained=explained)
        return success(explained=explained)
