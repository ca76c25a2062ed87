"""What skills ask of arms, and what a driver must do; numpy only, so that checks stay light.

World frame: origin at the table's centre, x along its long side, y away from the robot,
z up, z = 0 on the table's surface. A tool frame has z out of the hand and x along the
opening direction of the fingers.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, Protocol, TypeVar, runtime_checkable

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Arm = Literal["left", "right"]
ARMS: tuple[Arm, Arm] = ("left", "right")
Grip = Literal["open", "cage", "pinch"]
# Names of the arms of any robot; those of the YuMi are `Arm`.
ArmName = TypeVar("ArmName", bound=str)


@dataclass(frozen=True, slots=True, eq=False)
class TcpGoal:
    """Where the tool centre point of one arm should be, gripper pointing down.

    Attributes:
        position_m: In the world frame [m], shape (3,).
        yaw_rad: Direction of finger opening in the table plane, from world x [rad]; None
            leaves it free. The gripper is symmetric: yaw and yaw + pi are the same grasp.
        max_tilt_rad: How far the tool may lean from straight down where that is out of
            reach [rad].
        onward_m: Straight tool motions, one after the other, that the arm must be able to make
            from there, e.g. down onto a cable: vectors in the world [m], shape (3,) each.
    """

    position_m: Floats
    yaw_rad: float | None = None
    max_tilt_rad: float = 0.52
    onward_m: tuple[Floats, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class PoseGoal:
    """Where a tool should be, in any orientation, e.g. level before a shelf.

    Attributes:
        position_m: In the world frame [m], shape (3,).
        quat_xyzw: Orientation of the tool in the world, shape (4,).
        turns_rad: Turns about the tool's own z axis that serve as well; 0 stands for the
            orientation itself.
        max_tilt_rad: How far the tool's z axis may lean from there where that is out of
            reach [rad].
        onward_m: Straight tool motions that must be possible from there, as in `TcpGoal`.
    """

    position_m: Floats
    quat_xyzw: Floats
    turns_rad: tuple[float, ...] = (0.0,)
    max_tilt_rad: float = 0.0
    onward_m: tuple[Floats, ...] = ()


Goal = TcpGoal | PoseGoal
Cause = Literal["reach", "joint_limit", "collision", "onward", "search", "timing", "moving"]


PathStrategy = Literal["straight_edge", "rrt_connect", "detour", "roadmap"]


@dataclass(frozen=True, slots=True)
class StrategyTried:
    """A way of looking for a path that found none.

    Attributes:
        name: Which one.
        ends: Configurations that it was to lead to.
    """

    name: PathStrategy
    ends: int


@dataclass(frozen=True, slots=True)
class MotionFailure:
    """Why a motion cannot be planned.

    Attributes:
        code: `motion.unreachable`, `motion.collision`, `motion.no_path` or `motion.timing`.
        stage: `ik`, `path`, `line`, `timing` or `verify`.
        text: A sentence for people, with arm, goal, pair and distance where known.
        pair: Names of the two bodies that collide, if that is the cause.
        cause: What hinders, finer than the code.
        distance_m: How far apart the pair is where it is closest to being free; below 0 they
            overlap.
        joint: Name of the joint whose limit hinders, if that is the cause.
        tried: Descents, paths or ways along a line that were tried.
        strategies: How a path was looked for, in order, if none was found.
        elapsed_ms: What the answer cost on this machine; not the same from run to run.
    """

    code: str
    stage: str
    text: str
    pair: tuple[str, str] | None = None
    cause: Cause | None = None
    distance_m: float | None = None
    joint: str | None = None
    tried: int = 0
    strategies: tuple[StrategyTried, ...] = ()
    elapsed_ms: float | None = field(default=None, compare=False)


@runtime_checkable
class Trajectory(Protocol):
    """A timed, checked joint motion of all arms of a robot; exact at any rate."""

    @property
    def duration_s(self) -> float:
        """Length in time [s]."""
        ...

    def at(self, time_s: float) -> tuple[Floats, Floats, Floats]:
        """Return position, velocity and acceleration [rad, rad/s, rad/s2], shape (n,) each.

        Joints are in the order of the robot's configurations, of two arms the left one's
        first, each in chain order. Times outside [0, duration] give the first or the last state.
        """
        ...


@dataclass(frozen=True, slots=True, eq=False)
class ArmsState:
    """State of all arms of a robot, and of their grippers.

    Attributes:
        positions_rad: Joint positions, shape (n,), of two arms the left one's first.
        velocities_rad_s: Joint velocities, shape (n,).
        accelerations_rad_s2: Commanded joint accelerations, shape (n,).
        openings_m: Distance between the fingers of each gripper [m]; empty without grippers.
        moving: Whether a trajectory or a stop is being executed; also while it is held.
        stamp_s: On the cell's clock [s].
    """

    positions_rad: Floats
    velocities_rad_s: Floats
    accelerations_rad_s2: Floats
    openings_m: Mapping[Arm, float]
    moving: bool
    stamp_s: float


@runtime_checkable
class JointsDriver(Protocol):
    """Talks to the controllers of all joints of a robot; never blocks."""

    def state(self) -> ArmsState:
        """Return the latest state."""
        ...

    def execute(self, trajectory: Trajectory) -> None:
        """Start a trajectory that begins at the present state.

        Raises:
            DeviceError: It begins elsewhere, or another one is running.
        """
        ...

    def hold(self) -> None:
        """Bring a trajectory to rest on its own path within all limits, to be taken up again.

        Nothing happens while none is executed; a stop goes on.
        """
        ...

    def go_on(self) -> None:
        """Take up a trajectory that was held, within all limits."""
        ...

    def held(self) -> bool:
        """Return whether a trajectory rests on its path."""
        ...

    def stop(self) -> None:
        """Bring all joints to rest within their jerk limits; tools keep what they hold.

        What was executed or held is given up.
        """
        ...

    def emergency_stop(self) -> None:
        """Stop as fast as the brakes allow, and take no more commands; from any thread."""
        ...


@runtime_checkable
class ArmsDriver(JointsDriver, Protocol):
    """Talks to the controllers of two arms with grippers; never blocks."""

    def grip(self, arm: Arm, grip: Grip) -> None:
        """Start opening or closing a gripper: `open` 50 mm, `cage` a ring, `pinch` shut."""
        ...

    def gripping(self, arm: Arm) -> bool:
        """Return whether the fingers are still on their way."""
        ...

    def holds(self, arm: Arm) -> bool:
        """Return whether something is between the closed fingers (they are not shut)."""
        ...


@runtime_checkable
class DualArm(Protocol):
    """Two arms as skills use them: plan, start, wait tick by tick.

    Plans begin at the present state, avoid collisions between arms, body and table, and are
    verified at control rate before they may run.
    """

    def plan(self, goals: Mapping[Arm, TcpGoal]) -> Trajectory | MotionFailure:
        """Plan a free motion that takes each named arm to its goal; the others stay.

        Both arms move in synchrony when two are named.
        """
        ...

    def plan_line(self, displacements_m: Mapping[Arm, Floats]) -> Trajectory | MotionFailure:
        """Plan straight tool motions from the present poses, in step, orientation kept.

        Args:
            displacements_m: Vector of each named arm's tool in the world [m], shape (3,).
        """
        ...

    def plan_home(self) -> Trajectory | MotionFailure:
        """Plan a motion to the ready pose, arms out of the camera's view of the table."""
        ...

    def assign(self, goals: tuple[TcpGoal, TcpGoal]) -> tuple[Arm, Arm] | MotionFailure:
        """Say which arm takes which of two goals so that both can be reached at once."""
        ...

    def reachable(self, arm: Arm, goal: TcpGoal) -> bool:
        """Return whether that arm alone could reach the goal without collision."""
        ...

    def tcp_position(self, arm: Arm) -> Floats:
        """Return the present position of a tool centre point in the world [m], shape (3,)."""
        ...

    def start(self, trajectory: Trajectory) -> None:
        """Hand a planned trajectory to the driver."""
        ...

    def moving(self) -> bool:
        """Return whether a motion or a gripper is still under way."""
        ...

    def grip(self, arm: Arm, grip: Grip) -> None:
        """Start opening or closing a gripper."""
        ...

    def holds(self, arm: Arm) -> bool:
        """Return whether something is between the fingers."""
        ...

    def hold(self) -> None:
        """Bring a motion to rest on its own path, to be taken up again by `go_on`."""
        ...

    def go_on(self) -> None:
        """Take up a motion that was held."""
        ...

    def resting(self) -> bool:
        """Return whether nothing moves: no motion is under way, or it is held."""
        ...

    def stop(self) -> None:
        """Bring both arms to rest within their jerk limits; a held motion is given up."""
        ...
