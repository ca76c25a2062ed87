"""Take both arms out of the camera's view."""

from executive.core.outcome import failure, success
from executive.core.skill import SkillRun
from skills.motion.arm_skill import ArmSkill


class GoHome(ArmSkill):
    """Open both grippers and move both arms to the ready pose, out of the camera's view.

    SUCCESS: both arms rest at the ready pose.
    FAILURE: no collision-free motion leads there.
    stop(): arms come to rest within their jerk limits, grippers stay as they are.
    """

    def run(self) -> SkillRun:
        """Open, plan, move."""
        yield from self._set_grips({"left": "open", "right": "open"})
        failed = yield from self._move(self._arms.plan_home)
        if failed is not None:
            return failure(failed.code, failed.text, stage=failed.stage)
        return success()
