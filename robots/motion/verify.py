"""The last look at a trajectory, at control rate: limits and collisions."""

from collections.abc import Iterator
from math import ceil

import numpy as np

from robots.interfaces import Floats, MotionFailure, Trajectory
from robots.limits import JointLimits
from robots.motion.collision import CollisionModel
from robots.motion.failures import collision_failure

CONTROL_PERIOD_S = 0.004
_TOLERANCE = 1e-3  # relative, on velocity and acceleration
_POSITION_SLACK_RAD = 1e-4  # a measured start may be that far beyond a limit


def sample(
    trajectory: Trajectory, period_s: float = CONTROL_PERIOD_S
) -> tuple[Floats, Floats, Floats, Floats]:
    """Return times (k,) and positions, velocities, accelerations (k, n), both ends included."""
    count = ceil(trajectory.duration_s / period_s) + 1
    times = np.linspace(0.0, trajectory.duration_s, count)
    states = [trajectory.at(float(time)) for time in times]
    position, velocity, acceleration = (np.array([s[k] for s in states]) for k in range(3))
    return times, position, velocity, acceleration


def find_fault(
    trajectory: Trajectory, limits: JointLimits, collision: CollisionModel
) -> MotionFailure | None:
    """Return what is wrong with a trajectory, or None when it may run."""
    times, position, velocity, acceleration = sample(trajectory)
    if not limits.contain(position, slack_rad=_POSITION_SLACK_RAD):
        return _timing("leaves the joint limits")
    if np.any(np.abs(velocity) > limits.velocity * (1 + _TOLERANCE)):
        return _timing("exceeds the velocity limits")
    if np.any(np.abs(acceleration) > limits.acceleration * (1 + _TOLERANCE)):
        return _timing("exceeds the acceleration limits")
    return next(_collisions(times, position, collision), None)


def _collisions(
    times: Floats, positions: Floats, collision: CollisionModel
) -> Iterator[MotionFailure]:
    for time, q in zip(times, positions, strict=True):
        if collision.collides(q):
            yield collision_failure(collision, q, "verify", f"after {time:.2f} s")


def _timing(text: str) -> MotionFailure:
    return MotionFailure("motion.timing", "verify", f"the timed motion {text}", cause="timing")
