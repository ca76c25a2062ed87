"""The controllers of the simulated arm: `robots.shelf_arm.driver.ShelfArmDriver`."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from robots.drivers.starting import refuse_after_emergency
from robots.interfaces import ArmsState, Trajectory
from robots.limits import JointLimits
from robots.shelf_arm.driver import Guard
from simulation.following import Follower
from simulation.shelf_cell.physics import ShelfPhysics
from simulation.shelf_cell.suction import Cups

Floats = NDArray[np.float64]

# The force sensor's low pass [s]: solvers of contact jitter from step to step, sensors do not.
_FORCE_LAG_S = 0.012


class SimShelfArmDriver:
    """Follows trajectories, watches the force, works the valve, step by step with the world."""

    def __init__(
        self,
        physics: ShelfPhysics,
        cups: Cups,
        now_s: Callable[[], float],
        limits: JointLimits,
        force_noise_n: float,
        rng: np.random.Generator,
    ) -> None:
        """Take over an arm at rest.

        Args:
            physics: Where the arm is.
            cups: What the valve works.
            now_s: Tells the time.
            limits: Of a stop.
            force_noise_n: Standard deviation of the force sensor, each axis.
            rng: Source of that noise.
        """
        self._physics, self._cups, self._now_s = physics, cups, now_s
        self._follower = Follower(limits, lambda: physics.joint_state()[0])
        self._force_noise_n, self._rng = force_noise_n, rng
        self._force_n: Floats = np.zeros(3)
        self._guard: Guard | None = None
        self._tripped = False

    @property
    def at_rest(self) -> bool:
        """Whether no joint moves; a held motion rests."""
        return self._follower.resting

    @property
    def motion(self) -> Trajectory | None:
        """The motion that is executed, also while it is held; None at rest and in a stop."""
        return self._follower.motion

    def advance(self, duration_s: float) -> None:
        """Send the arm where it has to be `duration_s` from now."""
        self._follower.advance(duration_s)
        self._physics.drive(self._follower.target_rad)

    def sense(self, duration_s: float) -> None:
        """Take in what the step has done to the tool."""
        self._cups.advance(duration_s)
        share = min(1.0, duration_s / _FORCE_LAG_S)
        self._force_n = self._force_n + share * (self._outer_force_n() - self._force_n)
        guard = self._guard
        if guard is not None and self._follower.moving and not self._tripped:
            against_n = -float(self.force_n() @ guard.direction)
            if against_n > guard.most_n:
                self._tripped = True
                self._follower.brake()
        if self._tripped and self._follower.moving is False:
            # Joints that were stopped short of where they were to be would press on.
            self._follower.rest_at(self._physics.joint_state()[0])
            self._guard = None

    def state(self) -> ArmsState:
        """Return the present state."""
        positions, velocities = self._physics.joint_state()
        return ArmsState(
            positions_rad=positions,
            velocities_rad_s=velocities,
            accelerations_rad_s2=self._follower.acceleration.copy(),
            openings_m={},
            moving=self._follower.moving,
            stamp_s=self._now_s(),
        )

    def execute(self, trajectory: Trajectory) -> None:
        """Start a trajectory that begins at the present state.

        Raises:
            DeviceError: It begins elsewhere, or another one is running.
        """
        self._follower.execute(trajectory)
        self._tripped = False

    def guard(self, guard: Guard | None) -> None:
        """Watch the force from now on, or stop watching."""
        self._guard = guard

    def tripped(self) -> bool:
        """Return whether the guard has ended the last motion."""
        return self._tripped

    def force_n(self) -> Floats:
        """Return the force on the tool from outside [N], world axes, shape (3,)."""
        return self._force_n + self._rng.normal(0.0, self._force_noise_n, 3)

    def suck(self, on: bool) -> None:
        """Open or shut the valve of the cups."""
        refuse_after_emergency(self._follower.latched)
        self._cups.switch(on)

    def holds(self) -> bool:
        """Return whether the cups are sealed."""
        return bool(self._cups.held)

    def hold(self) -> None:
        """Bring a trajectory to rest on its own path within all limits, to be taken up again."""
        self._follower.hold()

    def go_on(self) -> None:
        """Take up a trajectory that was held, within all limits."""
        self._follower.go_on()

    def held(self) -> bool:
        """Return whether a trajectory rests on its path."""
        return self._follower.held()

    def stop(self) -> None:
        """Bring all joints to rest within their jerk limits; cups keep what they hold."""
        self._follower.stop()

    def emergency_stop(self) -> None:
        """Stop as fast as the brakes allow, for good; cups keep what they hold."""
        self._follower.emergency_stop()

    def _outer_force_n(self) -> Floats:
        held = self._cups.held
        by_box_n = self._physics.forces_on_arm_n()
        if held:
            by_box_n[held] = self._physics.outer_force_n(held)
        return np.sum([np.zeros(3), *by_box_n.values()], axis=0)
