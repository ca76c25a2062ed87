"""The controllers of the simulated arms: `robots.interfaces.ArmsDriver` over `YumiBody`."""

import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from executive.core.errors import DeviceError
from robots.drivers.starting import refuse_after_emergency, refuse_elsewhere, refuse_while_moving
from robots.interfaces import ARMS, Arm, ArmsState, Floats, Grip, Trajectory
from robots.limits import JointLimits
from robots.motion import feed
from robots.motion.stopping import stop_trajectory
from simulation.cable.rod import Rod
from simulation.grippers import Gripper
from simulation.yumi_body import YumiBody

# Brakes take out speed four times as fast as a motion would, and bite at once.
_BRAKE_ACCELERATION, _BRAKE_JERK = 4.0, 1000.0
_Mode = Literal["rest", "motion", "stop", "brake"]


@dataclass(frozen=True, slots=True, eq=False)
class DriverState:
    """The controllers at rest, grippers empty.

    Attributes:
        target_rad: Where the arms are held, shape (14,).
        grips: What the fingers were last told to do.
        openings_m: Where they are.
    """

    target_rad: Floats
    grips: Mapping[Arm, Grip]
    openings_m: Mapping[Arm, float]


class SimArmsDriver:
    """Follows trajectories and moves fingers, step by step with the world."""

    def __init__(
        self, body: YumiBody, rod: Rod, now_s: Callable[[], float], limits: JointLimits
    ) -> None:
        """Take over a body at rest, grippers open; both hands must be known to the rod.

        Args:
            body: The arms.
            rod: What the hands take hold of.
            now_s: Tells the time.
            limits: Of a stop.
        """
        self._body, self._now_s, self._limits = body, now_s, limits
        self._grippers: dict[Arm, Gripper] = {arm: Gripper(arm, rod) for arm in ARMS}
        self._mode: _Mode = "rest"
        # What is executed, and the motion that it executes: the same, until that is held.
        self._trajectory: Trajectory | None = None
        self._motion: Trajectory | None = None
        self._wants_hold = self._holds_feed = self._ended = self._latched = False
        self._lock = threading.RLock()
        self._elapsed_s = 0.0
        self._target_rad = body.joint_state()[0]
        self._acceleration: Floats = np.zeros_like(self._target_rad)

    @property
    def at_rest(self) -> bool:
        """Whether neither an arm nor a finger moves; a held motion rests."""
        arms = self._mode == "rest" or self.held()
        return arms and not any(g.moving for g in self._grippers.values())

    def advance(self, duration_s: float) -> None:
        """Send the body where it has to be `duration_s` from now."""
        with self._lock:
            self._follow(duration_s)
            for gripper in self._grippers.values():
                gripper.advance(duration_s)
            self._body.drive(self._target_rad, self._openings())

    def _follow(self, duration_s: float) -> None:
        if self._trajectory is None:
            return
        # The step after the last one takes out the speed with which the end was reached.
        self._ended = self._elapsed_s >= self._trajectory.duration_s
        self._elapsed_s += duration_s
        self._target_rad, _, self._acceleration = self._trajectory.at(self._elapsed_s)
        if self._ended and not self.held():
            self._rest()
        self._feed()

    def state(self) -> ArmsState:
        """Return the present state."""
        positions, velocities = self._body.joint_state()
        return ArmsState(
            positions_rad=positions,
            velocities_rad_s=velocities,
            accelerations_rad_s2=self._acceleration.copy(),
            openings_m=self._body.openings_m(),
            moving=self._mode != "rest",
            stamp_s=self._now_s(),
        )

    def rest_state(self) -> DriverState:
        """Return what the controllers go on from.

        Raises:
            DeviceError: Something moves or is held, which a state at rest does not tell.
        """
        holding = [arm for arm in ARMS if self.holds(arm)]
        if holding or not self.at_rest or self.held():
            got = f"the {holding[0]} gripper holds something" if holding else "something moves"
            raise DeviceError(f"arms: no state to go on from; got {got}; expected arms at rest")
        grips = {arm: gripper.grip for arm, gripper in self._grippers.items()}
        return DriverState(self._target_rad.copy(), grips, dict(self._openings()))

    def take_rest_state(self, state: DriverState) -> None:
        """Hold arms and fingers where they rested; the body must stand there already."""
        self._rest()
        self._target_rad = state.target_rad.copy()
        for arm, gripper in self._grippers.items():
            gripper.take_state(state.grips[arm], state.openings_m[arm])

    def execute(self, trajectory: Trajectory) -> None:
        """Start a trajectory that begins at the present state.

        Raises:
            DeviceError: It begins elsewhere, or another one is running.
        """
        with self._lock:
            refuse_after_emergency(self._latched)
            refuse_while_moving(self._mode)
            refuse_elsewhere(trajectory, self._body.joint_state()[0])
            self._motion = trajectory
            self._begin(trajectory, "motion")

    def grip(self, arm: Arm, grip: Grip) -> None:
        """Start opening or closing a gripper; a closing one takes what is between its fingers."""
        with self._lock:
            refuse_after_emergency(self._latched)
            self._grippers[arm].command(grip)

    def gripping(self, arm: Arm) -> bool:
        """Return whether the fingers are still on their way."""
        return self._grippers[arm].moving

    def holds(self, arm: Arm) -> bool:
        """Return whether something is between the closed fingers."""
        return self._grippers[arm].strands > 0

    def hold(self) -> None:
        """Bring a trajectory to rest on its own path within all limits, to be taken up again."""
        self._wish(hold=True)

    def go_on(self) -> None:
        """Take up a trajectory that was held, within all limits."""
        self._wish(hold=False)

    def held(self) -> bool:
        """Return whether a trajectory rests on its path."""
        way = self._trajectory
        return self._ended and isinstance(way, feed.FedTrajectory) and way.rate == 0.0

    def stop(self) -> None:
        """Bring all joints to rest within their jerk limits; fingers finish what they began."""
        with self._lock:
            if self._mode == "motion":
                self._end_motion(self._limits, "stop")

    def emergency_stop(self) -> None:
        """Stop as fast as the brakes allow, for good; fingers finish what they began."""
        with self._lock:
            self._latched = True
            if self._mode in ("motion", "stop"):
                limits = replace(
                    self._limits,
                    acceleration=_BRAKE_ACCELERATION * self._limits.acceleration,
                    jerk=_BRAKE_JERK * self._limits.jerk,
                )
                self._end_motion(limits, "brake")

    def _wish(self, hold: bool) -> None:
        with self._lock:
            self._wants_hold = hold and self._mode == "motion"
            self._feed()

    def _feed(self) -> None:
        """Begin a ramp of the feed when one is wished for, one ramp after the other."""
        way, motion = self._trajectory, self._motion
        if self._mode != "motion" or self._wants_hold == self._holds_feed or motion is None:
            return
        shown_s, rate = self._elapsed_s, 1.0
        if isinstance(way, feed.FedTrajectory):
            if way.ramping(self._elapsed_s):
                return
            shown_s, rate = way.progress_s(self._elapsed_s), way.rate
        self._holds_feed = self._wants_hold
        if self._wants_hold:
            self._follow_anew(feed.held(motion, shown_s, rate, self._limits))
        elif rate == 0.0:  # otherwise it was to end before it could be held
            self._follow_anew(feed.resumed(motion, shown_s, self._limits))

    def _end_motion(self, limits: JointLimits, mode: _Mode) -> None:
        assert self._trajectory is not None
        # Brake from where the motion is meant to be: measured speeds and accelerations jitter.
        position, velocity, acceleration = self._trajectory.at(self._elapsed_s)
        commanded = replace(
            self.state(),
            positions_rad=position,
            velocities_rad_s=velocity,
            accelerations_rad_s2=acceleration,
        )
        self._begin(stop_trajectory(commanded, limits), mode)

    def _begin(self, trajectory: Trajectory, mode: _Mode) -> None:
        self._mode = mode
        self._follow_anew(trajectory)
        self._wants_hold = self._holds_feed = False

    def _follow_anew(self, trajectory: Trajectory) -> None:
        self._trajectory, self._elapsed_s, self._ended = trajectory, 0.0, False

    def _rest(self) -> None:
        self._trajectory, self._motion, self._mode = None, None, "rest"
        self._wants_hold = self._holds_feed = False
        self._acceleration = np.zeros_like(self._target_rad)

    def _openings(self) -> Mapping[Arm, float]:
        return {arm: gripper.opening_m for arm, gripper in self._grippers.items()}
