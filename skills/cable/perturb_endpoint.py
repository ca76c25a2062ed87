"""Move an end of the cable a little, away from what lies beside it."""

from typing import Annotated

import numpy as np

from executive.core.outcome import failure, success
from executive.core.skill import In, Skill, SkillRun
from perception.cable.types import Endpoint
from perception.camera import CameraFrame
from robots.interfaces import DualArm
from skills.cable.grasping import CLEARANCE_M, first_reachable, grasp_goal
from skills.motion.steps import MOTION_REASONS, descend, move_by, release, set_grips

# Thesis section 3.5: uniform displacement in a square of 10 cm x 10 cm.
HALF_SQUARE_M = 0.05
# Where to hold: behind the connector, measured from the detected end into the cable.
HOLD_BEHIND_PX = (25.0, 40.0, 60.0)
LIFT_M = 0.03


class PerturbEndpoint(Skill):
    """Grasp the cable behind its surest reachable end and shift it by a random step.

    SUCCESS: the cable was held, moved and laid down.
    FAILURE: `grasp.unreachable` when no arm reaches any end; `grasp.missed` when the
        fingers closed on nothing; a motion reason.
    stop(): arms come to rest; a held cable stays held.
    """

    REASONS = MOTION_REASONS | {"grasp.unreachable", "grasp.missed"}
    ACTS = True

    def __init__(self, arms: DualArm, rng: np.random.Generator) -> None:
        """Bind the arms and the mission's random numbers."""
        self._arms, self._rng = arms, rng

    def run(
        self,
        frame: Annotated[CameraFrame, In("overhead frame")],
        endpoints: Annotated[tuple[Endpoint, ...], In("ends of the cable, surest first")],
    ) -> SkillRun:
        """Grasp, lift, shift, lay down, rise."""
        goals = [
            grasp_goal(frame, end.position_px + behind * end.direction, end.direction)
            for end in endpoints
            for behind in HOLD_BEHIND_PX
        ]
        found = first_reachable(self._arms, goals)
        yield
        if found is None:
            return failure("grasp.unreachable", "no arm reaches an end", ends=len(endpoints))
        arm, goal = found
        failed = yield from descend(self._arms, {arm: goal}, CLEARANCE_M)
        if failed is None:
            yield from set_grips(self._arms, {arm: "pinch"})
            if not self._arms.holds(arm):
                yield from release(self._arms, (arm,), CLEARANCE_M)
                return failure("grasp.missed", f"the {arm} gripper closed on nothing")
            step_m = self._rng.uniform(-HALF_SQUARE_M, HALF_SQUARE_M, 2)
            for leg in ((0.0, 0.0, LIFT_M), (*step_m, 0.0), (0.0, 0.0, -LIFT_M)):
                failed = failed or (yield from move_by(self._arms, {arm: np.array(leg)}))
        risen = yield from release(self._arms, (arm,), CLEARANCE_M)
        failed = failed or risen
        if failed is not None:
            return failure(failed.code, failed.text, stage=failed.stage)
        return success()

    def stop(self) -> None:
        """Bring the arms to rest."""
        self._arms.stop()
