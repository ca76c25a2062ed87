"""Straight tool motions of one or both arms, in step, with the orientation of the tools kept."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil

import numpy as np
import pinocchio as pin
import ruckig
from scipy.interpolate import CubicSpline

from robots.interfaces import Arm, Floats
from robots.limits import JointLimits
from robots.motion.ik import solve_pose
from robots.motion.model import RobotModel
from robots.motion.timing import JointState, Piece, connect

SAMPLE_SPACING_M = 0.005
_LARGEST_STEP_RAD = 0.25  # between samples; more means that the arm jumps to another branch
_RATE_CHECK_S = 0.002


@dataclass(frozen=True, slots=True)
class LineStop:
    """Where a line cannot go on: the arm, and the fraction of the line that is possible."""

    arm: Arm
    fraction: float


def follow_line(
    robot: RobotModel, start_rad: Floats, displacements_m: Mapping[Arm, Floats]
) -> Floats | LineStop:
    """Return configurations of all arms along straight lines of their tools, shape (k, n).

    Samples are equally spaced in the fraction of the line, from the start to its end.

    Args:
        robot: The robot.
        start_rad: Present configuration of all arms, shape (n,).
        displacements_m: Vector of each moving tool in the world [m], shape (3,).
    """
    longest = max(float(np.linalg.norm(d)) for d in displacements_m.values())
    count = max(4, ceil(longest / SAMPLE_SPACING_M))
    samples = np.tile(start_rad, (count + 1, 1))
    for arm, displacement in displacements_m.items():
        joints = robot.joints_of(arm)
        kinematics = robot.kinematics[arm]
        q = start_rad[joints]
        T_start = kinematics.tcp_pose(q)
        for number in range(1, count + 1):
            fraction = number / count
            target = pin.SE3(T_start.rotation, T_start.translation + fraction * displacement)
            following = solve_pose(kinematics, target, q)
            if following is None or np.abs(following - q).max() > _LARGEST_STEP_RAD:
                return LineStop(arm, (number - 1) / count)
            samples[number, joints] = q = following
    return samples


class LineTrajectory:
    """A curve through configurations q(s), s in [0, 1], driven by a jerk-limited s(t)."""

    def __init__(self, samples: Floats, profile: Piece) -> None:
        """Take equally spaced configurations, shape (k, n), and a motion of s from 0 to 1."""
        self._curve = CubicSpline(np.linspace(0.0, 1.0, len(samples)), samples)
        self._velocity = self._curve.derivative(1)
        self._acceleration = self._curve.derivative(2)
        self._jerk = self._curve.derivative(3)
        self._profile = profile

    @property
    def duration_s(self) -> float:
        """Length in time [s]."""
        return self._profile.duration_s

    def at(self, time_s: float) -> JointState:
        """Return position, velocity and acceleration; outside, the first or last state."""
        state = self._profile.at(min(max(time_s, 0.0), self.duration_s))
        s, v, a = (float(value[0]) for value in state)
        slope = self._velocity(s)
        return self._curve(s), slope * v, self._acceleration(s) * v * v + slope * a

    def excess(self, limits: JointLimits) -> float:
        """Return by what factor the motion would have to be slowed down to keep limits.

        Below 1 it could run faster. Slowing by f divides velocity by f, acceleration by
        f squared and jerk by f cubed.
        """
        times = np.linspace(0.0, self.duration_s, ceil(self.duration_s / _RATE_CHECK_S) + 2)
        states = [self._profile.at(t) for t in times]
        s, v, a = (np.array([state[k][0] for state in states])[:, None] for k in range(3))
        j = np.gradient(a[:, 0], times)[:, None]
        first, second, third = (
            curve(s[:, 0]) for curve in (self._velocity, self._acceleration, self._jerk)
        )
        velocity = first * v
        acceleration = second * v**2 + first * a
        jerk = third * v**3 + 3 * second * v * a + first * j
        return max(
            float(np.max(np.abs(velocity) / limits.velocity)),
            float(np.max(np.abs(acceleration) / limits.acceleration)) ** (1 / 2),
            float(np.max(np.abs(jerk) / limits.jerk)) ** (1 / 3),
        )


def time_line(
    samples: Floats, limits: JointLimits, fraction_speed_1_s: float
) -> LineTrajectory | None:
    """Return the motion along sampled configurations, as fast as limits allow.

    Args:
        samples: Equally spaced configurations, shape (k, n).
        limits: Limits of the joints.
        fraction_speed_1_s: Largest rate of the fraction s, from the tool's speed limit [1/s].
    """
    curve = CubicSpline(np.linspace(0.0, 1.0, len(samples)), samples)
    slopes = np.abs(curve.derivative(1)(np.linspace(0.0, 1.0, 2 * len(samples)))).max(axis=0)
    rate = limits.along(slopes)
    rate.velocity[0] = min(rate.velocity[0], fraction_speed_1_s)
    profile = _profile(rate)
    if profile is None:
        return None
    line = LineTrajectory(samples, profile)
    slower = line.excess(limits) * 1.001
    if slower <= 1.0:
        return line
    profile = _profile(rate.slowed(1.0 / slower))
    return LineTrajectory(samples, profile) if profile else None


def _profile(rate: JointLimits) -> Piece | None:
    zero: Floats = np.zeros(1)
    return connect((zero, zero, zero), (np.ones(1), zero, zero), rate, ruckig.Synchronization.Time)
