"""Motions of several arms at once, each at its own pace, checked together in time.

Each arm is planned and timed alone. Of all ways to start one arm later than the other, the one is
taken that is over first and free of collisions at every moment (priorities with delays, as in
Erdmann and Lozano-Perez, Algorithmica 1987).
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from robots.interfaces import ArmName, Floats, Trajectory
from robots.motion.collision import CollisionModel
from robots.motion.model import RobotModel
from robots.motion.timing import JointState

_CHECK_S = 0.02
_DELAY_S = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class Delayed:
    """A motion that begins later.

    Attributes:
        motion: Of all joints; those of other arms rest in it.
        delay_s: Before it begins.
    """

    motion: Trajectory
    delay_s: float

    @property
    def end_s(self) -> float:
        """When it is over."""
        return self.delay_s + self.motion.duration_s


class SideBySide:
    """Motions of different arms in one; itself a `Trajectory`."""

    def __init__(self, robot: RobotModel, motions: Mapping[ArmName, Delayed]) -> None:
        """Take a motion an arm; arms without one rest where the first motion has them."""
        self._joints = {arm: robot.joints_of(arm) for arm in motions}
        self._motions = dict(motions.items())

    @property
    def duration_s(self) -> float:
        """Length in time [s]."""
        return max(motion.end_s for motion in self._motions.values())

    def at(self, time_s: float) -> JointState:
        """Return position, velocity and acceleration; outside, the first or last state."""
        states = {
            arm: one.motion.at(min(max(time_s - one.delay_s, 0.0), one.motion.duration_s))
            for arm, one in self._motions.items()
        }
        first = next(iter(states.values()))
        whole = first[0].copy(), np.zeros_like(first[1]), np.zeros_like(first[2])
        for arm, state in states.items():
            for row, values in zip(whole, state, strict=True):
                row[self._joints[arm]] = values[self._joints[arm]]
        return whole


def beside_each_other(
    robot: RobotModel, collision: CollisionModel, motions: Mapping[ArmName, Trajectory]
) -> SideBySide | None:
    """Return two motions beside each other, one delayed if need be; None when none is free.

    Args:
        robot: The robot.
        collision: All of its arms and what stands around them.
        motions: Of two arms.
    """
    for delays_s in _delays(list(motions.values())):
        delayed = {
            arm: Delayed(motion, delay_s)
            for (arm, motion), delay_s in zip(motions.items(), delays_s, strict=True)
        }
        together = SideBySide(robot, delayed)
        if _free(together, collision):
            return together
    return None


def _delays(motions: Sequence[Trajectory]) -> Iterator[tuple[float, float]]:
    """Yield delays of two motions, those that are over first before others."""
    first_s, second_s = (motion.duration_s for motion in motions)
    one = [(float(d), 0.0) for d in np.arange(0.0, second_s + _DELAY_S, _DELAY_S)]
    other = [(0.0, float(d)) for d in np.arange(_DELAY_S, first_s + _DELAY_S, _DELAY_S)]
    yield from sorted(
        (*one, *other), key=lambda d: (max(d[0] + first_s, d[1] + second_s), d[0] + d[1])
    )


def _free(motion: SideBySide, collision: CollisionModel) -> bool:
    times: Floats = np.arange(0.0, motion.duration_s + _CHECK_S, _CHECK_S)
    return not any(collision.collides(motion.at(float(time))[0]) for time in times)
