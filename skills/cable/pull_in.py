"""Pull cable towards the middle of the table (the thesis's exposure move)."""

from collections.abc import Iterator
from typing import Annotated

import numpy as np

from executive.core.outcome import failure, success
from executive.core.skill import In, Skill, SkillRun
from perception.cable.types import Trace
from perception.camera import CameraFrame
from robots.interfaces import DualArm, Floats, TcpGoal
from skills.cable.grasping import CLEARANCE_M, first_reachable, grasp_goal, tangent_at
from skills.motion.steps import MOTION_REASONS, descend, move_by, release, set_grips

# Try a grasp every so many pixels, walking back along the trace from where it ended.
STRIDE_PX = 20.0
FARTHEST_PX = 600.0
LIFT_M = 0.03


class PullIn(Skill):
    """Grasp the cable near the end of its trace and pull it towards the table's middle.

    SUCCESS: the cable was held, pulled and laid down.
    FAILURE: `grasp.unreachable` when no arm reaches the last 60 cm of the trace;
        `grasp.missed` when the fingers closed on nothing; a motion reason.
    stop(): arms come to rest; a held cable stays held.
    """

    REASONS = MOTION_REASONS | {"grasp.unreachable", "grasp.missed"}
    ACTS = True

    def __init__(self, arms: DualArm) -> None:
        """Bind the arms."""
        self._arms = arms

    def run(
        self,
        frame: Annotated[CameraFrame, In("overhead frame")],
        trace: Annotated[Trace, In("path of the cable")],
        distance_m: Annotated[float, In("how far to pull", "m")] = 0.25,
    ) -> SkillRun:
        """Grasp, lift, pull, lay down, rise."""
        found = first_reachable(self._arms, _goals_from_the_end(frame, trace))
        yield
        if found is None:
            return failure("grasp.unreachable", "no arm reaches the cable near the trace's end")
        arm, goal = found
        failed = yield from descend(self._arms, {arm: goal}, CLEARANCE_M)
        if failed is None:
            yield from set_grips(self._arms, {arm: "pinch"})
            if not self._arms.holds(arm):
                yield from release(self._arms, (arm,), CLEARANCE_M)
                return failure("grasp.missed", f"the {arm} gripper closed on nothing")
            inwards_m = towards_middle(goal.position_m, distance_m)
            for leg in (np.array([0.0, 0.0, LIFT_M]), inwards_m, np.array([0.0, 0.0, -LIFT_M])):
                failed = failed or (yield from move_by(self._arms, {arm: leg}))
        risen = yield from release(self._arms, (arm,), CLEARANCE_M)
        failed = failed or risen
        if failed is not None:
            return failure(failed.code, failed.text, stage=failed.stage)
        return success()

    def stop(self) -> None:
        """Bring the arms to rest."""
        self._arms.stop()


def towards_middle(position_m: Floats, distance_m: float) -> Floats:
    """Return the level displacement towards the table's middle, at most up to it."""
    level_m = np.array([-position_m[0], -position_m[1], 0.0])
    reach_m = float(np.linalg.norm(level_m))
    displacement: Floats = level_m * min(1.0, distance_m / max(reach_m, 1e-9))
    return displacement


def _goals_from_the_end(frame: CameraFrame, trace: Trace) -> Iterator[TcpGoal]:
    points_px = trace.points_px
    gaps_px = np.linalg.norm(np.diff(points_px, axis=0), axis=1)
    from_end_px = np.append(np.cumsum(gaps_px[::-1])[::-1], 0.0)
    for back_px in np.arange(STRIDE_PX, min(FARTHEST_PX, from_end_px[0]), STRIDE_PX):
        index = int(np.argmin(np.abs(from_end_px - back_px)))
        yield grasp_goal(frame, points_px[index], tangent_at(points_px, index))
