"""What skills that move the arms have in common: plans made beside the ticks, motions waited for.

The pieces are generators that `yield` while something is planned or moves, for `yield from`.
"""

from collections.abc import Callable, Generator, Mapping, Sequence
from typing import ParamSpec

import numpy as np

from executive.core.skill import Skill
from executive.core.work import Worker
from robots.interfaces import Arm, DualArm, Floats, Grip, MotionFailure, TcpGoal, Trajectory
from skills.motion.goals import above

MOTION_REASONS = frozenset(
    {"motion.unreachable", "motion.collision", "motion.no_path", "motion.timing"}
)
MotionSteps = Generator[None, None, MotionFailure | None]
P = ParamSpec("P")


class ArmSkill(Skill):
    """Base of skills that move the arms.

    Every motion is one of both arms together, so each of these skills claims both. A pause
    holds the motion on its path; `stop()` brings the arms to rest, grippers stay as they are.
    """

    REASONS = MOTION_REASONS
    ACTS = True
    CLAIMS = frozenset({"left_arm", "right_arm"})

    def __init__(self, arms: DualArm, worker: Worker) -> None:
        """Bind the arms, and who plans for them."""
        self._arms, self._worker = arms, worker

    def stop(self) -> None:
        """Bring the arms to rest."""
        self._arms.stop()

    def on_pause(self) -> None:
        """Hold the motion on its path."""
        self._arms.hold()

    def on_resume(self) -> None:
        """Take the motion up again."""
        self._arms.go_on()

    def resting(self) -> bool:
        """Return whether arms and fingers rest."""
        return self._arms.resting()

    def _move(
        self, plan: Callable[P, Trajectory | MotionFailure], *args: P.args, **kwargs: P.kwargs
    ) -> MotionSteps:
        """Plan a motion from where the arms rest, and execute it to its end."""
        # A skill that was halted for this one may have left the arms on their way to rest.
        while self._arms.moving():
            yield
        trajectory = yield from self._worker.run(plan, *args, **kwargs)
        if isinstance(trajectory, MotionFailure):
            return trajectory
        self._arms.start(trajectory)
        while self._arms.moving():
            yield
        return None

    def _set_grips(self, grips: Mapping[Arm, Grip]) -> Generator[None, None, None]:
        """Open or close grippers together and wait until they are done."""
        for arm, grip in grips.items():
            self._arms.grip(arm, grip)
        while self._arms.moving():
            yield

    def _descend(
        self,
        goals: Mapping[Arm, TcpGoal],
        clearance_m: float,
        onward_m: Mapping[Arm, Sequence[Floats]] | None = None,
    ) -> MotionSteps:
        """Go to `clearance_m` above each goal, then straight down onto it.

        Args:
            goals: Where tools go.
            clearance_m: From how high they come straight down.
            onward_m: Straight motions from there that each arm's configuration must allow; by
                default straight up again.
        """
        onward_m = onward_m or dict.fromkeys(goals, (np.array([0.0, 0.0, clearance_m]),))
        hover = {arm: above(goal, clearance_m, *onward_m[arm]) for arm, goal in goals.items()}
        failed = yield from self._move(self._arms.plan, hover)
        if failed is not None:
            return failed
        tips_m = {arm: self._arms.tcp_position(arm) for arm in goals}
        return (
            yield from self._move_by({arm: goals[arm].position_m - tips_m[arm] for arm in goals})
        )

    def _move_by(self, displacements_m: Mapping[Arm, Floats]) -> MotionSteps:
        """Move tools along straight lines from where they are, in step."""
        return (yield from self._move(self._arms.plan_line, displacements_m))

    def _release(self, involved: tuple[Arm, ...], rise_m: float) -> MotionSteps:
        """Open the grippers, then rise straight up so that nothing is dragged along."""
        yield from self._set_grips(dict.fromkeys(involved, "open"))
        up_m = np.array([0.0, 0.0, rise_m])
        return (yield from self._move_by(dict.fromkeys(involved, up_m)))
