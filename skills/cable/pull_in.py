"""Pull in cable that leaves the view (the thesis's exposure move)."""

from typing import Annotated

from executive.core.skill import In, SkillRun
from perception.cable.grasp_sites import sites_between
from perception.cable.types import Trace
from perception.camera import CameraFrame
from skills.cable.grasping import grasp_goal
from skills.cable.pulling import PullSkill

# How far back from the end of the trace to look for a place to hold, as a share of it.
REACH_ARC = 0.25
# Nearer to the end of the trace the cable may hang over the edge of the table already.
EDGE_ARC = 0.02


class PullIn(PullSkill):
    """Grasp the cable near the end of its trace and pull it towards the table's middle.

    SUCCESS: the cable was held, pulled and laid down.
    FAILURE: `grasp.unreachable` when no arm reaches the last quarter of the trace;
        `grasp.missed` when the fingers closed on nothing; a motion reason.
    stop(): arms come to rest; a held cable stays held.
    """

    def run(
        self,
        frame: Annotated[CameraFrame, In("overhead frame")],
        trace: Annotated[Trace, In("path of the cable")],
        distance_m: Annotated[float, In("how far to pull", "m")] = 0.25,
    ) -> SkillRun:
        """Hold as near to the trace's end as an arm reaches, and pull."""
        sites = sites_between(trace, 1.0 - REACH_ARC, 1.0 - EDGE_ARC)[::-1]
        goals = (grasp_goal(frame, site.point_px, site.direction) for site in sites)
        return (yield from self.pull(goals, distance_m))
