"""Make a knot larger, so that two hands find room in it."""

from typing import Annotated

import numpy as np

from executive.core.outcome import failure
from executive.core.skill import In, SkillRun
from perception.cable.grasp_sites import GraspSite, sites_between
from perception.cable.polyline import arc_lengths
from perception.cable.types import Knot, Points, Trace
from perception.camera import CameraFrame
from robots.interfaces import Floats, TcpGoal
from skills.cable.carrying import CarrySkill
from skills.cable.grasping import grasp_goal

# A bight of a knot with less cable in it is locked: what pulls at it takes the knot along.
LEAST_M = 0.12
# Outwards by so much, or less where an arm cannot make it.
WAYS_M = (0.12, 0.08, 0.05)
# Room for fingers counts so much [1/px], being far out [1/px], and leading towards the middle of
# the table, which a knot far from it needs [1/m].
ROOM, OUTSIDE, INWARDS = 0.1, 0.05, 20.0


class OpenKnot(CarrySkill):
    """Grasp a bight of a knot where it lies farthest out and has room, and draw it outwards.

    Friction on the table holds the rest back, so the knot takes cable in from both sides.

    SUCCESS: the bight was held, drawn out and laid down.
    FAILURE: `knot.none` when there is no knot; `knot.tight` when there is too little cable in it
        to give; `grasp.unreachable` when no arm reaches it; `grasp.missed` when the fingers
        closed on nothing; a motion reason.
    stop(): arms come to rest; a held cable stays held.
    """

    REASONS = CarrySkill.REASONS | {"knot.none", "knot.tight"}

    def run(
        self,
        frame: Annotated[CameraFrame, In("overhead frame")],
        trace: Annotated[Trace, In("path of the cable")],
        knots: Annotated[tuple[Knot, ...], In("knots of the trace")],
    ) -> SkillRun:
        """Hold the first knot and draw."""
        if not knots:
            return failure("knot.none", "no knot was found to open")
        if (length_m := _length_m(frame, trace, knots[0])) < LEAST_M:
            return failure("knot.tight", "the knot has drawn together", length_m=length_m)
        sites = sites_between(trace, *knots[0].interval)
        if not sites:
            return failure("knot.tight", "the knot has no place to hold it at")
        middle_px = np.mean([site.point_px for site in sites], axis=0)
        middle_m = frame.camera.on_plane(middle_px)[0]
        values = [_openness(frame, site, middle_px, middle_m) for site in sites]
        order = [sites[k] for k in np.argsort([-value for value in values], kind="stable")]
        goals = [grasp_goal(frame, site.point_px, site.direction) for site in order]
        return (yield from self.carry(goals, lambda goal: ways_outwards(goal, middle_m)))


def ways_outwards(goal: TcpGoal, middle_m: Floats) -> list[Floats]:
    """Return level displacements away from the middle of a knot, the longest first."""
    out = _outwards(goal.position_m, middle_m)
    return [way_m * out for way_m in WAYS_M]


def _outwards(place_m: Floats, middle_m: Floats) -> Floats:
    """Return the level unit vector from the middle of a knot to a place on it."""
    out_m: Floats = (place_m - middle_m) * [1.0, 1.0, 0.0]
    return out_m / max(float(np.linalg.norm(out_m)), 1e-9)


def _openness(frame: CameraFrame, site: GraspSite, middle_px: Points, middle_m: Floats) -> float:
    """Return how good it is to draw a knot out at a place."""
    out = _outwards(frame.camera.on_plane(site.point_px)[0], middle_m)
    outside_px = float(np.linalg.norm(site.point_px - middle_px))
    return ROOM * site.room_px + OUTSIDE * outside_px - INWARDS * float(out @ middle_m)


def _length_m(frame: CameraFrame, trace: Trace, knot: Knot) -> float:
    """Return how much cable lies between where a knot begins and where it ends."""
    line_m = frame.camera.on_plane(trace.points_px)[:, :2]
    return (knot.interval[1] - knot.interval[0]) * float(arc_lengths(line_m)[-1])
