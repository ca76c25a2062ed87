"""A trajectory as samples, which is how it goes over a wire."""

import math
from dataclasses import dataclass

import numpy as np

from robots.interfaces import Floats, Trajectory

JOINTS = 14


@dataclass(frozen=True, slots=True, eq=False)
class SampledTrajectory:
    """States at equal steps of time; itself a `Trajectory`.

    Between samples, positions and velocities are cubic and accelerations linear, so that no
    jerk is above that of what was sampled. Where the jerk jumps between two samples, velocities
    are off by at most a quarter of the jump times the step squared.

    Attributes:
        period_s: Between samples.
        rows: Positions, velocities and accelerations, shape (n, 3, 14), n >= 2.
    """

    period_s: float
    rows: Floats

    @classmethod
    def of(cls, trajectory: Trajectory, period_s: float) -> "SampledTrajectory":
        """Sample a trajectory; the last sample is its end."""
        # Durations that are a whole number of periods but for rounding need no sample more.
        count = max(math.ceil(trajectory.duration_s / period_s - 1e-9), 1)
        return cls(period_s, np.array([trajectory.at(k * period_s) for k in range(count + 1)]))

    @classmethod
    def from_bytes(cls, period_s: float, data: bytes) -> "SampledTrajectory":
        """Read what `to_bytes` wrote.

        Raises:
            ValueError: These are no two whole samples of finite numbers.
        """
        rows = np.frombuffer(data, "<f8").reshape(-1, 3, JOINTS)
        if len(rows) < 2 or not np.isfinite(rows).all():
            raise ValueError("expected two samples or more, of finite numbers")
        return cls(period_s, rows)

    def to_bytes(self) -> bytes:
        """Return the samples as little-endian float64, sample after sample."""
        return self.rows.astype("<f8").tobytes()

    @property
    def duration_s(self) -> float:
        """Length in time [s]."""
        return (len(self.rows) - 1) * self.period_s

    def at(self, time_s: float) -> tuple[Floats, Floats, Floats]:
        """Return position, velocity and acceleration; outside, the first or last state."""
        place = min(max(time_s / self.period_s, 0.0), float(len(self.rows) - 1))
        index = min(int(place), len(self.rows) - 2)
        (q0, v0, a0), (q1, v1, a1) = self.rows[index], self.rows[index + 1]
        share = place - index
        # Rounding of times must not blur the samples themselves.
        if share < 1e-9:
            return q0.copy(), v0.copy(), a0.copy()
        return (
            _cubic(q0, q1, v0, v1, share, self.period_s),
            _cubic(v0, v1, a0, a1, share, self.period_s),
            (1.0 - share) * a0 + share * a1,
        )


def _cubic(y0: Floats, y1: Floats, d0: Floats, d1: Floats, x: float, step_s: float) -> Floats:
    """Return the cubic with given values and slopes at both ends, x within [0, 1]."""
    left = (1.0 + 2.0 * x) * y0 + x * step_s * d0
    right = (3.0 - 2.0 * x) * y1 - (1.0 - x) * step_s * d1
    return (1.0 - x) ** 2 * left + x**2 * right
