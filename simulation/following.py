"""Following trajectories step by step: to their end, on hold, to a stop; what drivers share."""

import threading
from collections.abc import Callable
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from robots.drivers.starting import refuse_after_emergency, refuse_elsewhere, refuse_while_moving
from robots.interfaces import ArmsState, Trajectory
from robots.limits import JointLimits
from robots.motion import feed
from robots.motion.stopping import stop_trajectory

Floats = NDArray[np.float64]

# Brakes take out speed four times as fast as a motion would, and bite at once.
_BRAKE_ACCELERATION, _BRAKE_JERK = 4.0, 1000.0
Mode = Literal["rest", "motion", "stop", "brake"]


class Follower:
    """Says where joints have to be, step by step; commands come from any thread.

    Attributes:
        target_rad: Where the joints have to be now, shape (n,).
        acceleration: What is commanded [rad/s2], shape (n,).
        latched: Whether an emergency stop was made, after which nothing is taken.
    """

    def __init__(self, limits: JointLimits, positions: Callable[[], Floats]) -> None:
        """Begin at rest where the joints are.

        Args:
            limits: Of a stop.
            positions: Tells where the joints are [rad], shape (n,).
        """
        self._limits, self._positions = limits, positions
        self._mode: Mode = "rest"
        # What is executed, and the motion that it executes: the same, until that is held.
        self._trajectory: Trajectory | None = None
        self._motion: Trajectory | None = None
        self._wants_hold = self._holds_feed = self._ended = self.latched = False
        self._lock = threading.RLock()
        self._elapsed_s = 0.0
        self.target_rad = positions()
        self.acceleration: Floats = np.zeros_like(self.target_rad)

    @property
    def moving(self) -> bool:
        """Whether a motion or a stop is under way; also while it is held."""
        return self._mode != "rest"

    @property
    def motion(self) -> Trajectory | None:
        """The motion that is executed, also while it is held; None at rest and in a stop."""
        return self._motion if self._mode == "motion" else None

    @property
    def resting(self) -> bool:
        """Whether the joints rest; those of a held motion do."""
        return self._mode == "rest" or self.held()

    def advance(self, duration_s: float) -> None:
        """Go on to where the joints have to be `duration_s` from now."""
        with self._lock:
            if self._trajectory is None:
                return
            # The step after the last one takes out the speed with which the end was reached.
            self._ended = self._elapsed_s >= self._trajectory.duration_s
            self._elapsed_s += duration_s
            self.target_rad, _, self.acceleration = self._trajectory.at(self._elapsed_s)
            if self._ended and not self.held():
                self._rest()
            self._feed()

    def execute(self, trajectory: Trajectory) -> None:
        """Start a trajectory that begins at the present state.

        Raises:
            DeviceError: It begins elsewhere, or another one is running.
        """
        with self._lock:
            refuse_after_emergency(self.latched)
            refuse_while_moving(self._mode)
            refuse_elsewhere(trajectory, self._positions())
            self._motion = trajectory
            self._begin(trajectory, "motion")

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
        """Bring all joints to rest within their jerk limits."""
        with self._lock:
            if self._mode == "motion":
                self._end_motion(self._limits, "stop")

    def emergency_stop(self) -> None:
        """Stop as fast as the brakes allow, for good."""
        with self._lock:
            self.latched = True
            self.brake()

    def brake(self) -> None:
        """Stop as fast as the brakes allow; other motions may follow."""
        with self._lock:
            if self._mode in ("motion", "stop"):
                limits = replace(
                    self._limits,
                    acceleration=_BRAKE_ACCELERATION * self._limits.acceleration,
                    jerk=_BRAKE_JERK * self._limits.jerk,
                )
                self._end_motion(limits, "brake")

    def rest_at(self, target_rad: Floats) -> None:
        """Give up what is under way and keep the joints at a place from now on."""
        with self._lock:
            self._rest()
            self.target_rad = target_rad.copy()

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

    def _end_motion(self, limits: JointLimits, mode: Mode) -> None:
        assert self._trajectory is not None
        # Brake from where the motion is meant to be: measured speeds and accelerations jitter.
        commanded = ArmsState(*self._trajectory.at(self._elapsed_s), {}, moving=True, stamp_s=0.0)
        self._begin(stop_trajectory(commanded, limits), mode)

    def _begin(self, trajectory: Trajectory, mode: Mode) -> None:
        self._mode = mode
        self._follow_anew(trajectory)
        self._wants_hold = self._holds_feed = False

    def _follow_anew(self, trajectory: Trajectory) -> None:
        self._trajectory, self._elapsed_s, self._ended = trajectory, 0.0, False

    def _rest(self) -> None:
        self._trajectory, self._motion, self._mode = None, None, "rest"
        self._wants_hold = self._holds_feed = False
        self.acceleration = np.zeros_like(self.target_rad)
