"""Failures of motions in words, each with what is known about it."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import wraps
from time import perf_counter
from typing import ParamSpec

import numpy as np

from robots.interfaces import Floats, MotionFailure, StrategyTried, Trajectory
from robots.motion.collision import CollisionModel
from robots.motion.model import RobotModel
from robots.motion.search import called

P = ParamSpec("P")
_Answer = Trajectory | MotionFailure


def costed(method: Callable[P, _Answer]) -> Callable[P, _Answer]:
    """Let a failure say what it cost."""

    @wraps(method)
    def timed(*args: P.args, **kwargs: P.kwargs) -> _Answer:
        began = perf_counter()
        answer = method(*args, **kwargs)
        if isinstance(answer, MotionFailure):
            return replace(answer, elapsed_ms=1e3 * (perf_counter() - began))
        return answer

    return timed


def collision_failure(
    collision: CollisionModel, positions_rad: Floats, stage: str, where: str
) -> MotionFailure:
    """Return a failure that names the two bodies that collide at a configuration."""
    pair = collision.colliding_pair(positions_rad)
    names = " and ".join(pair) if pair else "two bodies"
    distance_m = collision.distance_m(pair, positions_rad) if pair else None
    text = f"{where}, {names} collide"
    return MotionFailure("motion.collision", stage, text, pair, "collision", distance_m)


def beyond_limits(robot: RobotModel, positions_rad: Floats) -> MotionFailure:
    """Return a failure that names the joint that is farthest beyond its limits."""
    limits = robot.limits
    beyond = np.maximum(limits.lower - positions_rad, positions_rad - limits.upper)
    joint = int(beyond.argmax())
    name = [name for arm in robot.spec.arms.values() for name in arm.joints][joint]
    text = (
        f"{name} is beyond its limits in the configuration asked for; got "
        f"{positions_rad[joint]:.3f} rad; expected {limits.lower[joint]:.3f} to "
        f"{limits.upper[joint]:.3f} rad"
    )
    return MotionFailure("motion.unreachable", "path", text, cause="joint_limit", joint=name)


def no_path(arms: Sequence[str], strategies: Sequence[StrategyTried], checks: int) -> MotionFailure:
    """Return that no path was found to any of the configurations, and how it was looked for.

    Args:
        arms: Those that were to move.
        strategies: What was tried.
        checks: Collision checks that each search was given.
    """
    ends = max(strategy.ends for strategy in strategies)
    told = ", ".join(f"{strategy.name} to {strategy.ends}" for strategy in strategies)
    text = (
        f"{called(*arms)}: no path to any of {ends} configurations; tried {told}, each search "
        f"within {checks} collision checks"
    )
    return MotionFailure(
        "motion.no_path", "path", text, cause="search", tried=ends, strategies=tuple(strategies)
    )


def cut_short(arm: str, displacement_m: Floats, done: int, steps: int) -> MotionFailure:
    """Return how far of a line an arm gets.

    Args:
        arm: Which one.
        displacement_m: The whole line, shape (3,).
        done: Steps of it that are possible.
        steps: Steps that it has.
    """
    length_m = float(np.linalg.norm(displacement_m))
    text = (
        f"{called(arm)}: only {length_m * done / steps:.3f} m of the {length_m:.3f} m line is "
        "within the joint limits"
    )
    return MotionFailure("motion.unreachable", "line", text, cause="reach")


def untimed(stage: str) -> MotionFailure:
    """Return that no motion keeps the limits between two states."""
    text = "Ruckig found no motion between two states"
    return MotionFailure("motion.timing", stage, text, cause="timing")
