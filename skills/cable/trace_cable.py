"""Trace the cable from its start to wherever it leads."""

from typing import Annotated

from executive.core.outcome import failure, success
from executive.core.skill import In, Port, Skill, SkillRun
from executive.core.work import Worker
from perception.cable.interfaces import CableVision
from perception.cable.types import Endpoint, Trace, TraceStart
from perception.camera import CameraFrame


class TraceCable(Skill):
    """Trace one cable through the frame.

    SUCCESS: `trace` holds the path and why it ended (endpoint, edge, retrace, lost).
    FAILURE: `trace.none` when there is no cable at the start.
    """

    OUT = {"trace": Port(Trace, "path of the cable")}
    REASONS = frozenset({"trace.none"})

    def __init__(self, vision: CableVision, worker: Worker) -> None:
        """Bind perception, and who has the time for it."""
        self._vision, self._worker = vision, worker

    def run(
        self,
        frame: Annotated[CameraFrame, In("overhead frame")],
        start: Annotated[TraceStart, In("first points of the trace")],
        endpoints: Annotated[tuple[Endpoint, ...], In("ends where it may finish")],
    ) -> SkillRun:
        """Trace."""
        trace = yield from self._worker.run(
            self._vision.trace, frame.image, start.points_px, endpoints
        )
        if trace is None:
            return failure("trace.none", "there is no cable at the start point")
        return success(trace=trace)
