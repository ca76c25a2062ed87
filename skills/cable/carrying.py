"""Take the cable with one hand, carry it a little way, lay it down."""

from collections.abc import Callable, Iterable

import numpy as np

from executive.core.outcome import Outcome, failure, success
from executive.core.skill import SkillRun
from robots.interfaces import Floats, MotionFailure, TcpGoal
from skills.cable.grasping import CLEARANCE_M, LIFT_M, Carry, first_carry
from skills.motion.arm_skill import MOTION_REASONS, ArmSkill

# Where the other arm turns out to be in the way, these parts of it are tried in turn.
SHARES_OF_WAY = (1.0, 0.6, 0.3)
# Fingers that closed on nothing are tried elsewhere until so many have.
MOST_MISSES = 2


class CarrySkill(ArmSkill):
    """Base of skills that grasp one place of the cable and carry it somewhere."""

    REASONS = MOTION_REASONS | {"grasp.unreachable", "grasp.missed"}

    def carry(
        self, goals: Iterable[TcpGoal], ways_m: Callable[[TcpGoal], Iterable[Floats]]
    ) -> SkillRun:
        """Grasp where an arm can make a whole way, lift, go, lay down, rise.

        Args:
            goals: Where the cable may be taken, the best first.
            ways_m: Level ways to go from a goal, the best first.
        """
        left = list(goals)
        for _ in range(MOST_MISSES):
            found = yield from self._worker.run(first_carry, self._arms, left, ways_m)
            if found is None:
                return failure("grasp.unreachable", "no arm can take the cable and go on with it")
            outcome = yield from self._carry(found)
            if outcome.reason is None or outcome.reason.code != "grasp.missed":
                break
            left = left[left.index(found.goal) + 1 :]
        return outcome

    def _carry(self, found: Carry) -> SkillRun:
        """Go down, close, lift, go as far as it is free, lay down, rise."""
        arm = found.arm
        failed = yield from self._descend({arm: found.goal}, CLEARANCE_M, {arm: found.onward_m})
        if failed is not None:
            return motion_outcome(failed)
        yield from self._set_grips({arm: "pinch"})
        if not self._arms.holds(arm):
            yield from self._release((arm,), CLEARANCE_M)
            return failure("grasp.missed", f"the {arm} gripper closed on nothing")
        lift_m = np.array([0.0, 0.0, LIFT_M])
        failed = yield from self._move_by({arm: lift_m})
        for share in SHARES_OF_WAY:
            failed = yield from self._move_by({arm: share * found.way_m})
            if failed is None:
                break
        # Where a hand cannot lay it down at the end of its way, the cable falls these 3 cm.
        yield from self._move_by({arm: -lift_m})
        risen = yield from self._release((arm,), CLEARANCE_M)
        return motion_outcome(failed or risen)


def motion_outcome(failed: MotionFailure | None) -> Outcome:
    """Return the outcome of motions of which maybe one has failed."""
    if failed is not None:
        return failure(failed.code, failed.text, stage=failed.stage)
    return success()
