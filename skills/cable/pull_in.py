"""Pull in cable that leaves the view (the thesis's exposure move)."""

from collections.abc import Sequence
from itertools import product
from typing import Annotated

import numpy as np

from executive.core.skill import In, SkillRun
from perception.cable.grasp_sites import sites_between
from perception.cable.polyline import arc_lengths
from perception.cable.types import Trace
from perception.camera import CameraFrame
from robots.interfaces import Floats, TcpGoal
from robots.placement import TABLE_SIZE_M
from skills.cable.carrying import CarrySkill
from skills.cable.grasping import grasp_goal
from skills.cable.knot_sites import REACH_X_M, REACH_Y_M

# How far back from the end of the trace to look for a place to hold, as a share of it.
REACH_ARC = 0.25
# Nearer to the end of the trace the cable may hang over the edge of the table already.
EDGE_ARC = 0.02
# Cable nearer along the trace than the way, and this beyond it, comes along, and is not in its way.
OWN_M = 0.1
# Room beyond this on the way is as good as any [m], and ways are told apart by steps of this.
ENOUGH_M, STEP_M = 0.06, 0.02
# The end is to come to lie so far from the edge: what hangs draws at what was laid down.
INSIDE_M = 0.05
# Hands may go to places so far apart. Ways whose ends are nearer to each other are one, of which
# the first few are tried, and then parts of the first for an arm that cannot make a whole one.
GRID_M, ALIKE_M, MOST_WAYS = 0.05, 0.12, 5
SHARES_OF_WAY = (0.6, 0.3)


class PullIn(CarrySkill):
    """Grasp the cable near the end of its trace and pull it onto the table, where there is room.

    What hangs over an edge slides back unless all of it comes up: the hand goes as far away from
    that edge as the rest of the cable is long.

    SUCCESS: the cable was held, pulled and laid down.
    FAILURE: `grasp.unreachable` when no arm reaches the last quarter of the trace;
        `grasp.missed` when the fingers closed on nothing; a motion reason.
    stop(): arms come to rest; a held cable stays held.
    """

    def run(
        self,
        frame: Annotated[CameraFrame, In("overhead frame")],
        trace: Annotated[Trace, In("path of the cable")],
        length_m: Annotated[float, In("length of the cable; 0 where it is not known", "m")] = 0.0,
        hidden_m: Annotated[float, In("length out of view, where not known", "m")] = 0.2,
    ) -> SkillRun:
        """Hold as near to the trace's end as an arm reaches, and pull past other cable."""
        sites = sites_between(trace, 1.0 - REACH_ARC, 1.0 - EDGE_ARC)[::-1]
        goals = [grasp_goal(frame, site.point_px, site.direction) for site in sites]
        line_m = frame.camera.on_plane(trace.points_px)[:, :2]
        seen_m = float(arc_lengths(line_m)[-1])
        out_m = max(length_m - seen_m, 0.0) if length_m > 0.0 else hidden_m

        def ways_m(goal: TcpGoal) -> list[Floats]:
            return ways_from_edge(goal.position_m[:2], line_m, out_m)

        return (yield from self.carry(goals, ways_m))


def ways_from_edge(from_m: Floats, line_m: Floats, out_m: float) -> list[Floats]:
    """Return level ways of a hand that draw a cable in over an edge, the best first.

    The best bring all of it up; of these come those first that keep off the rest of the cable.

    Args:
        from_m: Where the hand takes hold, shape (2,).
        line_m: The cable, up to where it leaves the table, shape (N, 2).
        out_m: How much of it is beyond that.

    Returns:
        Ways, shape (3,) each; last come parts of the best one, for arms that cannot make a whole.
    """
    arcs_m = arc_lengths(line_m)
    held_m = float(arcs_m[int(np.linalg.norm(line_m - from_m, axis=1).argmin())])
    needed_m = float(arcs_m[-1]) - held_m + out_m + INSIDE_M

    def cost(way_m: Floats) -> tuple[int, int, float]:
        short_m = max(needed_m - _inwards_m(from_m + way_m[:2], line_m[-1]), 0.0)
        crowding = _crowding(way_m, from_m, line_m)
        return round(short_m / STEP_M), crowding, float(np.linalg.norm(way_m))

    places = product(np.arange(-REACH_X_M, REACH_X_M + 1e-9, GRID_M), np.arange(*REACH_Y_M, GRID_M))
    ways_m = [np.array([x - from_m[0], y - from_m[1], 0.0]) for x, y in places]
    whole = _unlike(sorted(ways_m, key=cost))[:MOST_WAYS]
    return whole + [share * whole[0] for share in SHARES_OF_WAY]


def _inwards_m(place_m: Floats, edge_m: Floats) -> float:
    """Return how far a place is from the edge at which the cable leaves, square to it."""
    axis = int(np.argmin(0.5 * np.array(TABLE_SIZE_M) - np.abs(edge_m)))
    return float(np.sign(edge_m[axis]) * (edge_m[axis] - place_m[axis]))


def _crowding(way_m: Floats, from_m: Floats, line_m: Floats) -> int:
    """Return how near a hand comes on its way to cable that does not come along, in steps."""
    arcs_m = arc_lengths(line_m)
    held_m = arcs_m[int(np.linalg.norm(line_m - from_m, axis=1).argmin())]
    path_m = from_m + np.linspace(0.2, 1.0, 9)[:, None] * way_m[:2]
    resting_m = line_m[arcs_m < held_m - float(np.linalg.norm(way_m)) - OWN_M]
    gaps_m = np.linalg.norm(path_m[:, None] - resting_m[None], axis=2)
    return -int(min(float(gaps_m.min(initial=ENOUGH_M)), ENOUGH_M) / STEP_M)


def _unlike(ways_m: Sequence[Floats]) -> list[Floats]:
    """Return those ways that do not lead near to where an earlier one leads."""
    kept = list[Floats]()
    for way_m in ways_m:
        if all(np.linalg.norm(way_m - other) > ALIKE_M for other in kept):
            kept.append(way_m)
    return kept
