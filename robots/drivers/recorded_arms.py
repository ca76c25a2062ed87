"""A driver that shows what arms did in a recorded run; nothing can be commanded."""

from collections.abc import Iterator
from typing import NoReturn

import numpy as np
from pydantic import BaseModel, ConfigDict, ValidationError

from executive.core.clock import Clock
from executive.core.errors import DeviceError, RecordingError
from executive.engine.recording.reader import Recording
from robots.descriptions.yumi import (
    CAGE_OPENING_M,
    FINGER_STROKE_M,
    OPEN_OPENING_M,
    arm_joint_names,
)
from robots.drivers.samples import JOINTS
from robots.interfaces import ARMS, Arm, ArmsState, Floats, Grip, Trajectory

_TOPIC = "/joint_states"
_JOINT_NAMES = [name for arm in ARMS for name in arm_joint_names(arm)]
_GRIPPER_NAMES = [f"{arm}_gripper" for arm in ARMS]
# What rounding in recordings, and a joint at rest, may amount to.
_SAME_M, _SAME_S, _STILL_RAD_S = 2e-4, 1e-9, 1e-3
# Of a recording in which nothing happens for longer, rest is to be shown as rest.
_LONGEST_PERIOD_S = 1.0
_EMPTY_M = np.array([0.0, CAGE_OPENING_M, OPEN_OPENING_M, 2.0 * FINGER_STROKE_M])


class _JointStates(BaseModel):
    """A message of the stream of joint states."""

    model_config = ConfigDict(frozen=True)

    names: list[str]
    positions: list[float]
    velocities: list[float]

    def row(self) -> list[float]:
        """Return positions, velocities and openings, 30 numbers."""
        positions = dict(zip(self.names, self.positions, strict=True))
        velocities = dict(zip(self.names, self.velocities, strict=True))
        return [
            *(positions[name] for name in _JOINT_NAMES),
            *(velocities[name] for name in _JOINT_NAMES),
            *(positions[name] for name in _GRIPPER_NAMES),
        ]


class RecordedArms:
    """An `ArmsDriver` whose arms are where those of a recording were at the time of a clock.

    Between messages, joints and fingers go evenly. A message that would repeat the one before
    it is not in a recording: arms rest here until a period before the next one. Accelerations
    are differences of velocities. Commands are refused, and a stop does nothing, because
    nothing moves that could be stopped.

    Attributes:
        start_s: Time of the first message, on the recorded cell's clock.
        end_s: Time of the last one.
    """

    def __init__(self, recording: Recording, clock: Clock) -> None:
        """Read the joint states of a recording.

        Args:
            recording: Of a cell with these two arms.
            clock: Says which moment to show; its time is that of the recorded cell.

        Raises:
            RecordingError: It holds no joint states of these arms.
        """
        self._file, self._clock = recording.path, clock
        moments = list(_moments(recording))
        if not moments:
            raise RecordingError(
                f"{recording.path}: no arms to show; got no message of {_TOPIC}; expected the "
                "recording of a cell with two arms"
            )
        self._times_s = np.array([time_s for time_s, _ in moments])
        self._rows = np.array([row for _, row in moments])
        self.start_s, self.end_s = float(self._times_s[0]), float(self._times_s[-1])
        gaps_s = np.diff(self._times_s)
        self._period_s = float(gaps_s[gaps_s > 0.0].min(initial=_LONGEST_PERIOD_S))

    def state(self) -> ArmsState:
        """Return the state at the clock's time; outside the run, its first or last."""
        now, rates = self._now()
        velocities = now[JOINTS : 2 * JOINTS]
        return ArmsState(
            positions_rad=now[:JOINTS],
            velocities_rad_s=velocities,
            accelerations_rad_s2=rates[JOINTS : 2 * JOINTS],
            openings_m=dict(zip(ARMS, now[2 * JOINTS :].tolist(), strict=True)),
            moving=bool(np.abs(velocities).max() > _STILL_RAD_S),
            stamp_s=self._clock.now_s(),
        )

    def gripping(self, arm: Arm) -> bool:
        """Return whether the fingers are on their way."""
        rate_m_s = self._now()[1][2 * JOINTS + ARMS.index(arm)]
        return bool(abs(rate_m_s) * self._period_s > _SAME_M)

    def holds(self, arm: Arm) -> bool:
        """Return whether the fingers rest where empty ones never do.

        A cage around one strand is as wide as an empty one, and counts as such.
        """
        opening_m = self._now()[0][2 * JOINTS + ARMS.index(arm)]
        return not self.gripping(arm) and bool(np.abs(_EMPTY_M - opening_m).min() > _SAME_M)

    def held(self) -> bool:
        """Return False: a recording does not tell a held motion from one that is over."""
        return False

    def stop(self) -> None:
        """Do nothing: there is nothing to stop."""

    def emergency_stop(self) -> None:
        """Do nothing: there is nothing to stop."""

    def execute(self, trajectory: Trajectory) -> None:  # noqa: ARG002 - the interface's
        """Refuse, with a `DeviceError`."""
        self._refuse("a trajectory")

    def grip(self, arm: Arm, grip: Grip) -> None:
        """Refuse, with a `DeviceError`."""
        self._refuse(f"{grip} for the {arm} gripper")

    def hold(self) -> None:
        """Refuse, with a `DeviceError`."""
        self._refuse("hold")

    def go_on(self) -> None:
        """Refuse, with a `DeviceError`."""
        self._refuse("go on")

    def _refuse(self, got: str) -> NoReturn:
        raise DeviceError(
            f"arms: {self._file} shows what was recorded; got {got}; expected no command; try: a "
            "simulated cell"
        )

    def _now(self) -> tuple[Floats, Floats]:
        """Return what the clock's moment has of each recorded number, and its rate of change."""
        time_s = self._clock.now_s()
        last = len(self._rows) - 1
        index = int(np.clip(np.searchsorted(self._times_s, time_s, "right") - 1, 0, last))
        following = min(index + 1, last)
        before, after = self._rows[index], self._rows[following]
        step_s = min(float(self._times_s[following] - self._times_s[index]), self._period_s)
        begun_s = time_s - float(self._times_s[following]) + step_s
        if begun_s < -_SAME_S or following == index or time_s < self.start_s:
            return before.copy(), np.zeros_like(before)
        share = float(np.clip(begun_s / step_s, 0.0, 1.0))
        return (1.0 - share) * before + share * after, (after - before) / step_s


def _moments(recording: Recording) -> Iterator[tuple[float, list[float]]]:
    """Yield time and numbers of each message of joint states.

    Raises:
        RecordingError: One is not of these arms.
    """
    for message in recording.streams():
        if message.topic == _TOPIC:
            try:
                yield message.time_s, _JointStates.model_validate_json(message.data).row()
            except (ValidationError, ValueError, KeyError) as cause:
                raise RecordingError(
                    f"{recording.path}: {_TOPIC} at {message.time_s:.3f} s: got no joint states of "
                    f"these arms ({type(cause).__name__}: {cause}); expected {_JOINT_NAMES[0]} to "
                    f"{_GRIPPER_NAMES[-1]}"
                ) from cause
