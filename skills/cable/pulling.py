"""Pull cable towards the middle of the table."""

from collections.abc import Iterable

import numpy as np

from executive.core.outcome import failure, success
from executive.core.skill import SkillRun
from robots.interfaces import Floats, TcpGoal
from skills.cable.grasping import CLEARANCE_M, first_reachable
from skills.motion.arm_skill import MOTION_REASONS, ArmSkill

LIFT_M = 0.03
# Where the whole way is out of reach, these parts of it are tried in turn.
SHARES_OF_WAY = (1.0, 0.6, 0.3)


class PullSkill(ArmSkill):
    """Base of skills that grasp one place of the cable and pull it towards the middle."""

    REASONS = MOTION_REASONS | {"grasp.unreachable", "grasp.missed"}

    def pull(self, goals: Iterable[TcpGoal], distance_m: float) -> SkillRun:
        """Grasp at the first goal that an arm reaches, lift, pull, lay down, rise."""
        found = yield from self._worker.run(first_reachable, self._arms, goals)
        if found is None:
            return failure("grasp.unreachable", "no arm reaches the cable there")
        arm, goal = found
        failed = yield from self._descend({arm: goal}, CLEARANCE_M)
        if failed is not None:
            return failure(failed.code, failed.text, stage=failed.stage)
        yield from self._set_grips({arm: "pinch"})
        if not self._arms.holds(arm):
            yield from self._release((arm,), CLEARANCE_M)
            return failure("grasp.missed", f"the {arm} gripper closed on nothing")
        lift_m = np.array([0.0, 0.0, LIFT_M])
        failed = yield from self._move_by({arm: lift_m})
        for share in SHARES_OF_WAY:
            inwards_m = towards_middle(goal.position_m, share * distance_m)
            failed = yield from self._move_by({arm: inwards_m})
            if failed is None:
                break
        laid = yield from self._move_by({arm: -lift_m})
        risen = yield from self._release((arm,), CLEARANCE_M)
        failed = failed or laid or risen
        if failed is not None:
            return failure(failed.code, failed.text, stage=failed.stage)
        return success()


def towards_middle(position_m: Floats, distance_m: float) -> Floats:
    """Return the level displacement towards the table's middle, at most up to it."""
    level_m = np.array([-position_m[0], -position_m[1], 0.0])
    reach_m = float(np.linalg.norm(level_m))
    displacement: Floats = level_m * min(1.0, distance_m / max(reach_m, 1e-9))
    return displacement
