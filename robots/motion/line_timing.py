"""Jerk-limited timing of a curve through many configurations, such as a straight tool motion."""

from math import ceil

import numpy as np
import ruckig
from scipy.interpolate import CubicSpline

from robots.interfaces import Floats
from robots.limits import JointLimits
from robots.motion.timing import JointState, Piece, connect

_RATE_CHECK_S = 0.001
_RESERVE = 1.02  # for peaks between two checks


class CurveTrajectory:
    """A curve through configurations q(s), s in [0, 1], driven by a jerk-limited s(t)."""

    def __init__(self, curve: CubicSpline, profile: Piece) -> None:
        """Take the curve and a motion of s from 0 to 1."""
        self._curve = curve
        self._slope, self._bend, self._twist = (curve.derivative(order) for order in (1, 2, 3))
        self._profile = profile

    @property
    def duration_s(self) -> float:
        """Length in time [s]."""
        return self._profile.duration_s

    def at(self, time_s: float) -> JointState:
        """Return position, velocity and acceleration; outside, the first or last state."""
        state = self._profile.at(min(max(time_s, 0.0), self.duration_s))
        s, v, a = (float(value[0]) for value in state)
        slope = self._slope(s)
        return self._curve(s), slope * v, self._bend(s) * v * v + slope * a

    def excess(self, limits: JointLimits) -> float:
        """Return by what factor the motion would have to be slowed down to keep limits.

        Slowing by f divides velocity by f, acceleration by f squared and jerk by f cubed.
        """
        times = np.linspace(0.0, self.duration_s, ceil(self.duration_s / _RATE_CHECK_S) + 2)
        states = np.array([self._profile.at(t) for t in times])
        s, v, a = states[:, 0, 0], states[:, 1], states[:, 2]
        j = np.gradient(a, times, axis=0)
        slope, bend, twist = self._slope(s), self._bend(s), self._twist(s)
        velocity = slope * v
        acceleration = bend * v**2 + slope * a
        jerk = twist * v**3 + 3.0 * bend * v * a + slope * j
        return max(
            float(np.max(np.abs(velocity) / limits.velocity)),
            float(np.max(np.abs(acceleration) / limits.acceleration)) ** (1 / 2),
            float(np.max(np.abs(jerk) / limits.jerk)) ** (1 / 3),
        )


def time_curve(samples_rad: Floats, limits: JointLimits, rate_1_s: float) -> CurveTrajectory | None:
    """Return the motion from rest to rest through configurations, as fast as limits allow.

    Args:
        samples_rad: Configurations equally spaced in s, shape (k, n).
        limits: Limits of the joints.
        rate_1_s: Largest rate of s [1/s], for example from a tool's speed limit.
    """
    curve = CubicSpline(np.linspace(0.0, 1.0, len(samples_rad)), samples_rad)
    slopes = np.abs(curve.derivative(1)(np.linspace(0.0, 1.0, 2 * len(samples_rad))))
    rates = limits.along(slopes.max(axis=0)).capped(rate_1_s)
    profile = _from_0_to_1(rates)
    if profile is None:
        return None
    # The bends of the curve cost something on top of its slopes.
    slower = CurveTrajectory(curve, profile).excess(limits) * _RESERVE
    if slower > 1.0:
        profile = _from_0_to_1(rates.slowed(1.0 / slower))
    return CurveTrajectory(curve, profile) if profile else None


def _from_0_to_1(rates: JointLimits) -> Piece | None:
    still: Floats = np.zeros(1)
    return connect(
        (still, still, still), (np.ones(1), still, still), rates, ruckig.Synchronization.Time
    )
