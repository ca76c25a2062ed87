"""A controller of two arms without mass: joints and fingers are where they are sent."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from executive.core.errors import DeviceError
from executive.core.work import Worker
from robots.drivers.messages import (
    Command,
    EmergencyStop,
    Execute,
    GoOn,
    GripCommand,
    Hold,
    Mode,
    Stop,
)
from robots.drivers.samples import SampledTrajectory
from robots.drivers.starting import refuse_after_emergency, refuse_elsewhere, refuse_while_moving
from robots.interfaces import ARMS, Arm, ArmsState, Floats, Trajectory
from robots.limits import JointLimits
from robots.motion.stopping import stop_trajectory
from simulation.loopback.fingers import Fingers
from simulation.loopback.playback import Playback

# Nothing smooths a jump of the command: it would be at most 0.025 rad/s in one cycle.
TOLERANCE_RAD = 1e-4
_BRAKE_ACCELERATION, _BRAKE_JERK = 4.0, 1000.0
_SPEED_SLACK = 1.01


class Controller:
    """Obeys commands and moves the joints, cycle by cycle.

    Attributes:
        mode: What the arms do.
        positions_rad: Where the joints are, shape (14,); likewise the two after it.
        velocities_rad_s: Their velocities.
        accelerations_rad_s2: Their accelerations.
        fingers: Of each arm.
    """

    def __init__(
        self,
        positions_rad: Floats,
        limits: JointLimits,
        cycle_s: float,
        between_m: Mapping[Arm, float],
        worker: Worker,
    ) -> None:
        """Begin at rest, grippers open.

        Args:
            positions_rad: Where the joints are, shape (14,).
            limits: Of motions and stops.
            cycle_s: Length of a cycle.
            between_m: Width of what is between the fingers.
            worker: Does what takes longer than a cycle.
        """
        self._limits, self._cycle_s, self._worker = limits, cycle_s, worker
        self.mode: Mode = "rest"
        self._playback: Playback | None = None
        self._latched = False
        self.positions_rad = positions_rad.copy()
        self.velocities_rad_s = self.accelerations_rad_s2 = np.zeros_like(positions_rad)
        self.fingers = {arm: Fingers(between_m.get(arm, 0.0)) for arm in ARMS}

    @property
    def held(self) -> bool:
        """Whether a motion rests on its path."""
        return self._playback is not None and self._playback.held

    @property
    def moving(self) -> bool:
        """Whether a joint moves, or is about to."""
        return self.mode != "rest" and not self.held

    def obey(self, command: Command) -> None:
        """Do what a command asks for.

        Raises:
            DeviceError: It cannot be done; nothing has changed.
        """
        match command:
            case Execute():
                self._execute(command)
            case GripCommand():
                refuse_after_emergency(self._latched)
                self.fingers[command.arm].command(command.grip)
            case Hold():
                if self._playback is not None and self.mode == "motion":
                    self._playback.hold()
            case GoOn():
                if self._playback is not None and self.mode == "motion":
                    self._playback.go_on()
            case Stop():
                self.stop()
            case EmergencyStop():
                self._brake()

    def stop(self) -> None:
        """Come to rest within the limits, and give up what is executed or held."""
        if self.mode == "motion":
            self._come_to_rest("stop", self._limits)

    def release(self) -> None:
        """Take commands again after an emergency stop; for a new driver."""
        self._latched = False

    def advance(self) -> None:
        """Move joints and fingers on by a cycle."""
        for fingers in self.fingers.values():
            fingers.advance(self._cycle_s)
        if self._playback is None:
            return
        self.positions_rad, self.velocities_rad_s, self.accelerations_rad_s2 = (
            self._playback.advance(self._cycle_s)
        )
        if self._playback.over:
            self._playback, self.mode = None, "rest"
            self.velocities_rad_s = self.accelerations_rad_s2 = np.zeros_like(self.positions_rad)

    def _execute(self, command: Execute) -> None:
        refuse_after_emergency(self._latched)
        refuse_while_moving(self.mode)
        try:
            trajectory = SampledTrajectory.from_bytes(command.period_s, command.samples)
        except ValueError as cause:
            raise DeviceError(f"arms: got a trajectory that is none; {cause}") from cause
        refuse_elsewhere(trajectory, self.positions_rad, TOLERANCE_RAD)
        _refuse_beyond_limits(trajectory, self._limits)
        self._show(trajectory, "motion")

    def _brake(self) -> None:
        self._latched = True
        if self.mode in ("motion", "stop"):
            limits = replace(
                self._limits,
                acceleration=_BRAKE_ACCELERATION * self._limits.acceleration,
                jerk=_BRAKE_JERK * self._limits.jerk,
            )
            self._come_to_rest("brake", limits)

    def _come_to_rest(self, mode: Mode, limits: JointLimits) -> None:
        state = ArmsState(
            self.positions_rad, self.velocities_rad_s, self.accelerations_rad_s2, {}, True, 0.0
        )
        self._show(stop_trajectory(state, limits), mode)

    def _show(self, trajectory: Trajectory, mode: Mode) -> None:
        self.mode, self._playback = mode, Playback(trajectory, self._limits, self._worker)


def _refuse_beyond_limits(trajectory: SampledTrajectory, limits: JointLimits) -> None:
    """Refuse samples that no joint could follow, or that do not end at rest.

    Raises:
        DeviceError: Says which.
    """
    positions, velocities = trajectory.rows[:, 0], trajectory.rows[:, 1]
    steps = np.abs(np.diff(positions, axis=0)) / trajectory.period_s
    what = ""
    if not limits.contain(positions, slack_rad=TOLERANCE_RAD):
        what = "a joint beyond its limits of position"
    elif (np.maximum(np.abs(velocities[1:]), steps) > _SPEED_SLACK * limits.velocity).any():
        what = "a joint faster than it may be"
    elif np.abs(velocities[[0, -1]]).max() > 1e-3:
        what = "samples that do not begin and end at rest"
    if what:
        raise DeviceError(
            f"arms: trajectory cannot be followed; got {what}; expected every sample within "
            "the limits; try: plan with the limits of this robot"
        )
