"""Coming to rest from any state of motion, within the jerk limits."""

import numpy as np
import ruckig

from executive.core.errors import DeviceError
from robots.interfaces import ArmsState, Floats, Trajectory
from robots.limits import JointLimits
from robots.motion.timing import JointState, Piece, PiecewiseTrajectory, solve

_COLLINEAR = 1e-6  # relative residual of acceleration across the direction of motion


class _StraightStop:
    """A stop along the straight edge on which the motion runs: position = base + s direction."""

    def __init__(self, base_rad: Floats, direction: Floats, profile: Piece) -> None:
        self._base = base_rad
        self._direction = direction
        self._profile = profile

    @property
    def duration_s(self) -> float:
        """Length in time [s]."""
        return self._profile.duration_s

    def at(self, time_s: float) -> JointState:
        """Return position, velocity and acceleration; outside, the first or last state."""
        s, v, a = self._profile.at(min(max(time_s, 0.0), self.duration_s))
        return self._base + s * self._direction, v * self._direction, a * self._direction


def stop_trajectory(state: ArmsState, limits: JointLimits) -> Trajectory:
    """Return the fastest jerk-limited way to rest.

    A motion along a straight edge stops on that edge, which was checked for collisions. Any
    other motion stops all joints in the same time; where that would carry one beyond its
    limits, each stops as fast as it can alone.

    Raises:
        DeviceError: The state is not finite.
    """
    straight = _straight_stop(state, limits)
    if straight is not None:
        return straight
    for synchronization in (ruckig.Synchronization.Time, ruckig.Synchronization.No):
        piece = _stop(
            state.positions_rad,
            state.velocities_rad_s,
            state.accelerations_rad_s2,
            limits,
            synchronization,
        )
        if limits.contain(piece.at(piece.duration_s)[0]):
            break
    return PiecewiseTrajectory([piece])


def _straight_stop(state: ArmsState, limits: JointLimits) -> _StraightStop | None:
    """Stop along the velocity's direction, or None when the acceleration is not along it."""
    velocity, acceleration = state.velocities_rad_s, state.accelerations_rad_s2
    lead = velocity if np.any(velocity) else acceleration
    size = float(np.linalg.norm(lead))
    if size == 0.0:
        return None
    direction = lead / size
    along = float(direction @ acceleration)
    if np.linalg.norm(acceleration - along * direction) > _COLLINEAR * (abs(along) + size):
        return None
    rate = float(direction @ velocity)
    profile = _stop(
        np.zeros(1),
        np.array([rate]),
        np.array([along]),
        limits.along(direction),
        ruckig.Synchronization.Time,
    )
    end = state.positions_rad + profile.at(profile.duration_s)[0] * direction
    return _StraightStop(state.positions_rad, direction, profile) if limits.contain(end) else None


def _stop(
    position: Floats,
    velocity: Floats,
    acceleration: Floats,
    limits: JointLimits,
    synchronization: ruckig.Synchronization,
) -> Piece:
    problem = ruckig.InputParameter(len(position))
    problem.control_interface = ruckig.ControlInterface.Velocity
    problem.current_position = position
    problem.current_velocity = velocity
    problem.current_acceleration = acceleration
    problem.target_velocity = problem.target_acceleration = np.zeros_like(position)
    problem.synchronization = synchronization
    piece = solve(problem, limits)
    if piece is None:
        raise DeviceError("stop: Ruckig finds no way to rest; got a state that is not finite")
    return piece
