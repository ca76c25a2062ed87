"""Pieces of motion that skills share, written as generators: `yield` while arms are moving."""

from collections.abc import Generator, Mapping

import numpy as np

from robots.interfaces import Arm, DualArm, Floats, Grip, MotionFailure, TcpGoal, Trajectory

MOTION_REASONS = frozenset(
    {"motion.unreachable", "motion.collision", "motion.no_path", "motion.timing"}
)
MotionSteps = Generator[None, None, MotionFailure | None]


def follow(arms: DualArm, plan: Trajectory | MotionFailure) -> MotionSteps:
    """Execute a plan to its end; hand a failed one back untouched."""
    if isinstance(plan, MotionFailure):
        return plan
    arms.start(plan)
    while arms.moving():
        yield
    return None


def set_grips(arms: DualArm, grips: Mapping[Arm, Grip]) -> Generator[None, None, None]:
    """Open or close grippers together and wait until they are done."""
    for arm, grip in grips.items():
        arms.grip(arm, grip)
    while arms.moving():
        yield


def descend(arms: DualArm, goals: Mapping[Arm, TcpGoal], clearance_m: float) -> MotionSteps:
    """Go to `clearance_m` above each goal, then straight down onto it."""
    rise_m = np.array([0.0, 0.0, clearance_m])
    above = {
        arm: TcpGoal(goal.position_m + rise_m, goal.yaw_rad, goal.max_tilt_rad)
        for arm, goal in goals.items()
    }
    failed = yield from follow(arms, arms.plan(above))
    if failed is not None:
        return failed
    down_m = {arm: goal.position_m - arms.tcp_position(arm) for arm, goal in goals.items()}
    return (yield from follow(arms, arms.plan_line(down_m)))


def move_by(arms: DualArm, displacements_m: Mapping[Arm, Floats]) -> MotionSteps:
    """Move tools along straight lines from where they are, in step."""
    return (yield from follow(arms, arms.plan_line(displacements_m)))


def release(arms: DualArm, involved: tuple[Arm, ...], rise_m: float) -> MotionSteps:
    """Open the grippers, then rise straight up so that nothing is dragged along."""
    yield from set_grips(arms, dict.fromkeys(involved, "open"))
    up_m = np.array([0.0, 0.0, rise_m])
    return (yield from move_by(arms, dict.fromkeys(involved, up_m)))
