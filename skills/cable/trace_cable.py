"""Trace the cable from its start to wherever it leads."""

from typing import Annotated

from executive.core.outcome import failure, success
from executive.core.skill import In, Port, Skill, SkillRun
from executive.core.work import Worker
from perception.cable.interfaces import CableVision
from perception.cable.types import COMPLETENESS, Endpoint, Trace, TraceStart
from perception.camera import CameraFrame
from skills.cable.over_edge import leaving

# A trace that tells as much as this about the whole cable needs no other one beside it.
ENOUGH = 0.5


class TraceCable(Skill):
    """Trace one cable through the frame.

    SUCCESS: `trace` holds the path and why it ended (endpoint, edge, retrace, lost); of several
        the one that tells most about the whole cable.
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
        other_ends: Annotated[bool, In("start at other ends where that tells more")] = False,
    ) -> SkillRun:
        """Trace, one start a tick."""
        others = [TraceStart.at(end) for end in endpoints if end is not start.endpoint]
        best: Trace | None = None
        for each in (start, *(others if other_ends else ())):
            trace = yield from self._worker.run(
                self._vision.trace, frame.image, each.points_px, endpoints
            )
            best = max((t for t in (best, trace) if t is not None), key=_telling, default=None)
            if best is not None and _telling(best) >= ENOUGH:
                break
        if best is None:
            return failure("trace.none", "there is no cable at the start point")
        return success(trace=leaving(best, frame))


def _telling(trace: Trace) -> float:
    """Return how much a trace can tell about the whole cable, in [0, 1]."""
    return trace.probability * COMPLETENESS[trace.end]
