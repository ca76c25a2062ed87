"""Let cable off that hangs over an arm."""

import numpy as np

from executive.core.outcome import success
from executive.core.skill import SkillRun
from robots.interfaces import ARMS, TcpGoal
from skills.motion.arm_skill import ArmSkill

# Both hands go down to the table here, and are drawn back from under the cable, level.
LOW_M = {"left": (-0.22, 0.05, 0.03), "right": (0.22, 0.05, 0.03)}
BACK_M = (0.0, -0.15, 0.0)


class ShakeOff(ArmSkill):
    """Lay down cable that hangs over an arm, and draw the hands from under it.

    SUCCESS: the hands went as far as they could; another look tells what has come of it.
    stop(): arms come to rest.
    """

    REASONS = frozenset()

    def run(self) -> SkillRun:
        """Go down, draw back."""
        lows = {arm: TcpGoal(np.array(LOW_M[arm]), 0.0) for arm in ARMS}
        if (yield from self._move(self._arms.plan, lows)) is None:
            yield from self._move_by({arm: np.array(BACK_M) for arm in ARMS})
        return success()
