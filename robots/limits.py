"""Limits of joints: position, speed, acceleration, jerk; numpy only, so that drivers share them."""

from dataclasses import dataclass

import numpy as np

from robots.descriptions.yumi import arm_joint_names, yumi
from robots.interfaces import ARMS, Floats

# Nothing is published about the YuMi's acceleration and jerk: full speed after 0.4 s and full
# acceleration after 0.1 s keep the tool near the 11 m/s2 of its brochure.
TIME_TO_FULL_SPEED_S = 0.4
TIME_TO_FULL_ACCELERATION_S = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class JointLimits:
    """Limits of a configuration, one array of shape (n,) each, in rad and seconds."""

    lower: Floats
    upper: Floats
    velocity: Floats
    acceleration: Floats
    jerk: Floats

    @classmethod
    def from_speeds(cls, lower: Floats, upper: Floats, velocity: Floats) -> "JointLimits":
        """Return limits whose acceleration and jerk follow from the speeds."""
        acceleration = velocity / TIME_TO_FULL_SPEED_S
        return cls(lower, upper, velocity, acceleration, acceleration / TIME_TO_FULL_ACCELERATION_S)

    def of(self, indices: slice | Floats) -> "JointLimits":
        """Return the limits of some of the joints."""
        return JointLimits(
            self.lower[indices],
            self.upper[indices],
            self.velocity[indices],
            self.acceleration[indices],
            self.jerk[indices],
        )

    def slowed(self, scale: float) -> "JointLimits":
        """Return the limits under which any motion takes 1 / scale times as long."""
        return JointLimits(
            self.lower,
            self.upper,
            self.velocity * scale,
            self.acceleration * scale**2,
            self.jerk * scale**3,
        )

    def capped(self, velocity: float) -> "JointLimits":
        """Return the limits with no velocity above a value."""
        slower = np.minimum(self.velocity, velocity)
        return JointLimits(self.lower, self.upper, slower, self.acceleration, self.jerk)

    def along(self, slopes: Floats) -> "JointLimits":
        """Return the limits of one parameter that moves joint i by `slopes[i]` a unit.

        Args:
            slopes: Shape (n,); the positions of the result are not limited.
        """
        reach = np.maximum(np.abs(slopes), 1e-9)
        rates = (self.velocity, self.acceleration, self.jerk)
        unlimited = np.array([np.inf])
        return JointLimits(-unlimited, unlimited, *(np.array([np.min(x / reach)]) for x in rates))

    def contain(self, positions_rad: Floats, slack_rad: float = 1e-9) -> bool:
        """Return whether all positions, shape (n,) or (k, n), are within the limits."""
        above = np.all(positions_rad >= self.lower - slack_rad)
        return bool(above and np.all(positions_rad <= self.upper + slack_rad))


def yumi_limits() -> JointLimits:
    """Return the limits of the YuMi's 14 arm joints, left arm first."""
    known = {joint.name: joint.limits for joint in yumi().joints if joint.limits is not None}
    rows = [known[name] for arm in ARMS for name in arm_joint_names(arm)]
    return JointLimits.from_speeds(
        np.array([row.lower for row in rows]),
        np.array([row.upper for row in rows]),
        np.array([row.velocity for row in rows]),
    )
