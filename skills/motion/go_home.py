"""Take both arms out of the camera's view."""

from executive.core.outcome import failure, success
from executive.core.skill import Skill, SkillRun
from robots.interfaces import DualArm
from skills.motion.steps import MOTION_REASONS, follow, set_grips


class GoHome(Skill):
    """Open both grippers and move both arms to the ready pose, out of the camera's view.

    SUCCESS: both arms rest at the ready pose.
    FAILURE: no collision-free motion leads there.
    stop(): arms come to rest within their jerk limits, grippers stay as they are.
    """

    REASONS = MOTION_REASONS
    ACTS = True

    def __init__(self, arms: DualArm) -> None:
        """Bind the arms."""
        self._arms = arms

    def run(self) -> SkillRun:
        """Open, plan, move."""
        yield from set_grips(self._arms, {"left": "open", "right": "open"})
        failed = yield from follow(self._arms, self._arms.plan_home())
        if failed is not None:
            return failure(failed.code, failed.text, stage=failed.stage)
        return success()

    def stop(self) -> None:
        """Bring the arms to rest."""
        self._arms.stop()
