"""Take both arms out of the camera's view."""

from executive.core.outcome import failure, success
from executive.core.skill import SkillRun
from robots.interfaces import MotionFailure
from skills.motion.arm_skill import MOTION_REASONS, ArmSkill

# How often it sets out, and how long a motion takes at most that leads nowhere.
MOST_TRIES = 3
THERE_S = 0.2


class GoHome(ArmSkill):
    """Open both grippers and move both arms to the ready pose, out of the camera's view.

    SUCCESS: both arms rest at the ready pose.
    FAILURE: no collision-free motion leads there; `motion.stopped` when something has stopped
        the arms on their way again and again.
    stop(): arms come to rest within their jerk limits, grippers stay as they are.
    """

    REASONS = MOTION_REASONS | {"motion.stopped"}

    def run(self) -> SkillRun:
        """Open, plan, move; again where something has stopped the arms on their way."""
        yield from self._set_grips({"left": "open", "right": "open"})
        for _ in range(MOST_TRIES):
            failed = yield from self._move(self._arms.plan_home)
            if failed is not None:
                return failure(failed.code, failed.text, stage=failed.stage)
            left = yield from self._worker.run(self._arms.plan_home)
            if not isinstance(left, MotionFailure) and left.duration_s <= THERE_S:
                return success()
        return failure("motion.stopped", f"arms were stopped {MOST_TRIES} times on their way home")
