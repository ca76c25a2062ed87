"""Pull in cable that leaves the view (the thesis's exposure move)."""

from collections.abc import Iterable
from typing import Annotated

import numpy as np

from executive.core.skill import In, SkillRun
from perception.cable.grasp_sites import sites_between
from perception.cable.polyline import arc_lengths
from perception.cable.types import Trace
from perception.camera import CameraFrame
from robots.interfaces import Floats, TcpGoal
from robots.placement import TABLE_SIZE_M
from skills.cable.grasping import grasp_goal
from skills.cable.pulling import PullSkill, ways_inwards

# How far back from the end of the trace to look for a place to hold, as a share of it.
REACH_ARC = 0.25
# Nearer to the end of the trace the cable may hang over the edge of the table already.
EDGE_ARC = 0.02
# Cable nearer along the trace than the way, and this beyond it, comes along, and is not in its way.
OWN_M = 0.1
# Room beyond this on the way is as good as any [m], and ways are told apart by steps of this.
ENOUGH_M, STEP_M = 0.06, 0.02


class PullIn(PullSkill):
    """Grasp the cable near the end of its trace and pull it onto the table, where there is room.

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
        """Hold as near to the trace's end as an arm reaches, and pull past other cable."""
        sites = sites_between(trace, 1.0 - REACH_ARC, 1.0 - EDGE_ARC)[::-1]
        goals = [grasp_goal(frame, site.point_px, site.direction) for site in sites]
        line_m = frame.camera.on_plane(trace.points_px)[:, :2]

        def ways_m(goal: TcpGoal) -> list[Floats]:
            ways = off_edge_first(ways_inwards(goal.position_m, distance_m), line_m[-1])
            return free_first(ways, goal.position_m[:2], line_m)

        return (yield from self.carry(goals, ways_m))


def off_edge_first(ways_m: Iterable[Floats], end_m: Floats) -> list[Floats]:
    """Return ways, those first that lead farthest away from the edge that the cable leaves over.

    A way along that edge draws little of the cable in.

    Args:
        ways_m: Level displacements, shape (3,) each.
        end_m: Where the cable leaves the table, shape (2,).
    """
    axis = int(np.argmin(0.5 * np.array(TABLE_SIZE_M) - np.abs(end_m)))
    return sorted(ways_m, key=lambda way_m: float(np.sign(end_m[axis]) * way_m[axis]))


def free_first(ways_m: list[Floats], from_m: Floats, line_m: Floats) -> list[Floats]:
    """Return ways of one hand over the table, those first that keep off the rest of the cable.

    Args:
        ways_m: Level displacements, shape (3,) each, the best first where there is room for all.
        from_m: Where the hand takes hold, shape (2,).
        line_m: The cable, shape (N, 2); what lies near the hand along it comes along.
    """
    arcs_m = arc_lengths(line_m)
    held_m = arcs_m[int(np.linalg.norm(line_m - from_m, axis=1).argmin())]
    shares = np.linspace(0.2, 1.0, 9)[:, None]

    def crowding(way_m: Floats) -> int:
        path_m = from_m + shares * way_m[:2]
        resting_m = line_m[arcs_m < held_m - float(np.linalg.norm(way_m)) - OWN_M]
        gaps_m = np.linalg.norm(path_m[:, None] - resting_m[None], axis=2)
        return -int(min(float(gaps_m.min(initial=ENOUGH_M)), ENOUGH_M) / STEP_M)

    return sorted(ways_m, key=crowding)
