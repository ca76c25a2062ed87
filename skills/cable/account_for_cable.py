"""Make sure that a trace leaves no cable out before anything is claimed about it."""

from dataclasses import replace
from typing import Annotated

import numpy as np

from executive.core.outcome import failure, success
from executive.core.skill import In, Port, Skill, SkillRun
from executive.core.work import Worker
from perception.cable.covered_ends import CONNECTOR_PX
from perception.cable.interfaces import CableVision
from perception.cable.types import Points, Trace, TraceEnd
from perception.camera import CameraFrame

# So many points before its end give the direction in which a trace would go on.
LEAD_POINTS = 5
STEP_PX = 4.0


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


def with_connectors(trace: Trace) -> Trace:
    """Return a trace that goes on along the connectors: it stops where they begin."""
    if trace.end is not TraceEnd.ENDPOINT or len(trace.points_px) < 2:
        return trace
    first, last = (_beyond(line) for line in (trace.points_px[::-1], trace.points_px))
    return replace(trace, points_px=np.vstack([first[::-1], trace.points_px, last]))


def _beyond(line: Points) -> Points:
    """Return points along a connector at the end of a line, shape (K, 2)."""
    back = line[-min(len(line), LEAD_POINTS)]
    outwards = (line[-1] - back) / max(float(np.linalg.norm(line[-1] - back)), 1e-9)
    along_px = np.arange(STEP_PX, CONNECTOR_PX + STEP_PX, STEP_PX)
    points: Points = line[-1] + along_px[:, None] * outwards
    return points
