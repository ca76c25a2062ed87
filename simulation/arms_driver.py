"""The controllers of the simulated arms: `robots.interfaces.ArmsDriver` over `YumiBody`."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from executive.core.errors import DeviceError
from robots.drivers.starting import refuse_after_emergency
from robots.interfaces import ARMS, Arm, ArmsState, Floats, Grip, Trajectory
from robots.limits import JointLimits
from simulation.cable.rod import Rod
from simulation.following import Follower
from simulation.grippers import Gripper
from simulation.yumi_body import YumiBody


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
        self._body, self._now_s = body, now_s
        self._grippers: dict[Arm, Gripper] = {arm: Gripper(arm, rod) for arm in ARMS}
        self._follower = Follower(limits, lambda: body.joint_state()[0])

    @property
    def at_rest(self) -> bool:
        """Whether neither an arm nor a finger moves; a held motion rests."""
        return self._follower.resting and not any(g.moving for g in self._grippers.values())

    @property
    def motion(self) -> Trajectory | None:
        """The motion that is executed, also while it is held; None at rest and in a stop."""
        return self._follower.motion

    def advance(self, duration_s: float) -> None:
        """Send the body where it has to be `duration_s` from now."""
        self._follower.advance(duration_s)
        for gripper in self._grippers.values():
            gripper.advance(duration_s)
        self._body.drive(self._follower.target_rad, self._openings())

    def state(self) -> ArmsState:
        """Return the present state."""
        positions, velocities = self._body.joint_state()
        return ArmsState(
            positions_rad=positions,
            velocities_rad_s=velocities,
            accelerations_rad_s2=self._follower.acceleration.copy(),
            openings_m=self._body.openings_m(),
            moving=self._follower.moving,
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
        return DriverState(self._follower.target_rad.copy(), grips, dict(self._openings()))

    def take_rest_state(self, state: DriverState) -> None:
        """Hold arms and fingers where they rested; the body must stand there already."""
        self._follower.rest_at(state.target_rad)
        for arm, gripper in self._grippers.items():
            gripper.take_state(state.grips[arm], state.openings_m[arm])

    def execute(self, trajectory: Trajectory) -> None:
        """Start a trajectory that begins at the present state.

        Raises:
            DeviceError: It begins elsewhere, or another one is running.
        """
        self._follower.execute(trajectory)

    def grip(self, arm: Arm, grip: Grip) -> None:
        """Start opening or closing a gripper; a closing one takes what is between its fingers."""
        refuse_after_emergency(self._follower.latched)
        self._grippers[arm].command(grip)

    def gripping(self, arm: Arm) -> bool:
        """Return whether the fingers are still on their way."""
        return self._grippers[arm].moving

    def holds(self, arm: Arm) -> bool:
        """Return whether something is between the closed fingers."""
        return self._grippers[arm].strands > 0

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
        """Bring all joints to rest within their jerk limits; fingers finish what they began."""
        self._follower.stop()

    def emergency_stop(self) -> None:
        """Stop as fast as the brakes allow, for good; fingers finish what they began."""
        self._follower.emergency_stop()

    def _openings(self) -> Mapping[Arm, float]:
        return {arm: gripper.opening_m for arm, gripper in self._grippers.items()}
