"""Pieces of motion that skills share, written as generators: `yield` while arms are moving."""

from collections.abc import Generator, Mapping
from dataclasses import replace

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


def above(goal: TcpGoal, clearance_m: float, *then_m: Floats) -> TcpGoal:
    """Return the goal from which a tool can go straight down onto `goal`, and on from there.

    Args:
        goal: Where the tool goes down to.
        clearance_m: Height above it.
        then_m: Straight motions that must be possible after that, one after the other.
    """
    down_m = np.array([0.0, 0.0, -clearance_m])
    return replace(goal, position_m=goal.position_m - down_m, onward_m=(down_m, *then_m))


def descend(arms: DualArm, goals: Mapping[Arm, TcpGoal], clearance_m: float) -> MotionSteps:
    """Go to `clearance_m` above each goal, then straight down onto it.

    Configurations are chosen from which the tool can also go straight up again.
    """
    up_m = np.array([0.0, 0.0, clearance_m])
    hover = {arm: above(goal, clearance_m, up_m) for arm, goal in goals.items()}
    failed = yield from follow(arms, arms.plan(hover))
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
