"""Move the cable where its trace was lost."""

from typing import Annotated

import numpy as np

from executive.core.skill import In, SkillRun
from perception.cable.types import Trace
from perception.camera import CameraFrame
from skills.cable.grasping import tangent_at
from skills.cable.shifting import Hold, ShiftSkill

# Where to hold: along the trace, back from where it was lost.
HOLD_BEHIND_PX = np.arange(40.0, 240.0, 20.0)


class PerturbTrace(ShiftSkill):
    """Grasp the cable shortly before its trace was lost and shift it into free space.

    Where a trace is lost, strands lie too close to be told apart: moving one tells which.

    SUCCESS: the cable was held, moved and laid down.
    FAILURE: `grasp.unreachable` when no arm reaches the last 24 cm of the trace;
        `grasp.missed` when the fingers closed on nothing; a motion reason.
    stop(): arms come to rest; a held cable stays held.
    """

    def run(
        self,
        frame: Annotated[CameraFrame, In("overhead frame")],
        trace: Annotated[Trace, In("path of the cable")],
    ) -> SkillRun:
        """Hold before the lost end and shift it."""
        path = trace.points_px
        gaps_px = np.linalg.norm(np.diff(path, axis=0), axis=1)
        from_end_px = np.append(np.cumsum(gaps_px[::-1])[::-1], 0.0)
        indices = [int(np.argmin(np.abs(from_end_px - behind))) for behind in HOLD_BEHIND_PX]
        holds = [Hold(path[i], tangent_at(path, i), path[-1]) for i in indices]
        return (yield from self.shift(frame, holds))
