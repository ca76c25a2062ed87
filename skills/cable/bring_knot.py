"""Bring a knot to where both arms reach it."""

from typing import Annotated

import numpy as np

from executive.core.outcome import failure
from executive.core.skill import In, SkillRun
from perception.cable.grasp_sites import sites_between
from perception.cable.types import Knot, Trace
from perception.camera import CameraFrame
from skills.cable.grasping import grasp_goal
from skills.cable.pulling import PullSkill

# A knot so near to the table's middle is where both arms reach best.
NEAR_M = 0.08


class BringKnot(PullSkill):
    """Grasp the cable of a knot at its roomiest place and pull it towards the table's middle.

    SUCCESS: the cable was held, pulled and laid down.
    FAILURE: `knot.none` when there is no knot; `knot.near` when it lies there already;
        `grasp.unreachable` when no arm reaches it; `grasp.missed` when the fingers closed on
        nothing; a motion reason.
    stop(): arms come to rest; a held cable stays held.
    """

    REASONS = PullSkill.REASONS | {"knot.none", "knot.near"}

    def run(
        self,
        frame: Annotated[CameraFrame, In("overhead frame")],
        trace: Annotated[Trace, In("path of the cable")],
        knots: Annotated[tuple[Knot, ...], In("knots of the trace")],
        distance_m: Annotated[float, In("how far to pull", "m")] = 0.15,
    ) -> SkillRun:
        """Hold the first knot and pull."""
        if not knots:
            return failure("knot.none", "no knot was found to bring nearer")
        sites = sorted(sites_between(trace, *knots[0].interval), key=lambda site: -site.room_px)
        places_m = [frame.camera.on_plane(site.point_px)[0] for site in sites]
        if sites and np.linalg.norm(np.mean(places_m, axis=0)) < NEAR_M:
            return failure("knot.near", "the knot lies in the middle of the table already")
        goals = (grasp_goal(frame, site.point_px, site.direction) for site in sites)
        return (yield from self.pull(goals, distance_m))
