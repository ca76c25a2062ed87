"""Two arms as skills use them: `robots.interfaces.DualArm` over any driver."""

import threading
from collections.abc import Callable, Mapping
from functools import wraps
from typing import Concatenate, ParamSpec, TypeVar

import numpy as np
from pydantic import JsonValue

from executive.core.errors import InputError
from robots.interfaces import (
    ARMS,
    Arm,
    ArmsDriver,
    Floats,
    Grip,
    MotionFailure,
    TcpGoal,
    Trajectory,
)
from robots.motion.model import yumi_model
from robots.motion.planner import MotionPlanner, PlannerSettings
from robots.placement import HOME_RAD, PlanningScene, table_scene

P = ParamSpec("P")
T = TypeVar("T")


def _one_at_a_time(
    method: Callable[Concatenate["PlannedDualArm", P], T],
) -> Callable[Concatenate["PlannedDualArm", P], T]:
    """Let threads use the planner one after the other."""

    @wraps(method)
    def guarded(self: "PlannedDualArm", /, *args: P.args, **kwargs: P.kwargs) -> T:
        with self._planning:
            return method(self, *args, **kwargs)

    return guarded


class PlannedDualArm:
    """Plans with a model of the robot, hands checked trajectories to a driver."""

    def __init__(
        self,
        driver: ArmsDriver,
        *,
        seed: int,
        scene: PlanningScene | None = None,
        settings: PlannerSettings | None = None,
    ) -> None:
        """Bind a driver; nothing moves.

        Args:
            driver: Controllers of both arms.
            seed: Of everything random in planning.
            scene: Placement of the robot, and the boxes around it; the table cell's when None.
            settings: Effort and speed of plans.
        """
        self._driver = driver
        scene = scene or table_scene()
        self._robot = yumi_model(scene.placement)
        self._planner = MotionPlanner(self._robot, scene, HOME_RAD, seed, settings)
        # Plans may be made in threads, and one that nobody waits for any more is still at it.
        self._planning = threading.RLock()

    @_one_at_a_time
    def plan(self, goals: Mapping[Arm, TcpGoal]) -> Trajectory | MotionFailure:
        """Plan a free motion that takes each named arm to its goal; the others stay."""
        start = self._rest()
        if isinstance(start, MotionFailure):
            return start
        return self._planner.to_goals(start, goals)

    @_one_at_a_time
    def plan_line(self, displacements_m: Mapping[Arm, Floats]) -> Trajectory | MotionFailure:
        """Plan straight tool motions from the present poses, in step, orientation kept."""
        start = self._rest()
        if isinstance(start, MotionFailure):
            return start
        return self._planner.along_lines(start, displacements_m)

    @_one_at_a_time
    def plan_home(self) -> Trajectory | MotionFailure:
        """Plan a motion to the ready pose, arms out of the camera's view of the table."""
        start = self._rest()
        if isinstance(start, MotionFailure):
            return start
        return self._planner.to_configuration(start, HOME_RAD)

    @_one_at_a_time
    def assign(self, goals: tuple[TcpGoal, TcpGoal]) -> tuple[Arm, Arm] | MotionFailure:
        """Say which arm takes which of two goals so that both can be reached at once.

        The left arm stands at the side of negative x, so it is offered the smaller x first.
        """
        present = self._note_state()
        first_is_left = goals[0].position_m[0] <= goals[1].position_m[0]
        orders = (ARMS, ARMS[::-1]) if first_is_left else (ARMS[::-1], ARMS)
        failures = []
        for order in orders:
            named = dict(zip(order, goals, strict=True))
            answer = self._planner.solver.configurations(named, present, count=4)
            if not isinstance(answer, MotionFailure):
                return order
            failures.append(answer)
        return failures[0]

    @_one_at_a_time
    def reachable(self, arm: Arm, goal: TcpGoal) -> bool:
        """Return whether that arm alone could reach the goal without collision."""
        present = self._note_state()
        return self._planner.solver.reaches(arm, goal, present)

    def tcp_position(self, arm: Arm) -> Floats:
        """Return the present position of a tool centre point in the world [m], shape (3,)."""
        positions = self._driver.state().positions_rad
        return self._robot.tcp_pose(arm, positions).translation.copy()

    def start(self, trajectory: Trajectory) -> None:
        """Hand a planned trajectory to the driver."""
        self._driver.execute(trajectory)

    def moving(self) -> bool:
        """Return whether a motion or a gripper is still under way."""
        return self._driver.state().moving or any(self._driver.gripping(arm) for arm in ARMS)

    def grip(self, arm: Arm, grip: Grip) -> None:
        """Start opening or closing a gripper."""
        self._driver.grip(arm, grip)

    def holds(self, arm: Arm) -> bool:
        """Return whether something is between the fingers."""
        return self._driver.holds(arm)

    def hold(self) -> None:
        """Bring a motion to rest on its own path, to be taken up again by `go_on`."""
        self._driver.hold()

    def go_on(self) -> None:
        """Take up a motion that was held."""
        self._driver.go_on()

    def resting(self) -> bool:
        """Return whether nothing moves: no motion is under way, or it is held."""
        fingers = any(self._driver.gripping(arm) for arm in ARMS)
        return not fingers and (self._driver.held() or not self._driver.state().moving)

    def stop(self) -> None:
        """Bring both arms to rest within their jerk limits."""
        self._driver.stop()

    def memento(self) -> JsonValue:
        """Return what planning remembers: how many plans there have been."""
        return {"plans": self._planner.requests}

    def recall(self, memento: JsonValue) -> None:
        """Plan as the arms went on to plan from which the memento is."""
        match memento:
            case {"plans": int(plans)}:
                self._planner.requests = plans
            case _:
                raise InputError(f"arms: got memento {memento!r}; expected the number of plans")

    def _note_state(self) -> Floats:
        state = self._driver.state()
        self._planner.observe(state.positions_rad, state.openings_m)
        return state.positions_rad

    def _rest(self) -> Floats | MotionFailure:
        """Return the present configuration, provided that the arms rest."""
        state = self._driver.state()
        if state.moving:
            fastest = float(np.abs(state.velocities_rad_s).max())
            text = f"arms are still moving at {fastest:.2f} rad/s; plan when they rest"
            return MotionFailure("motion.timing", "path", text)
        return self._note_state()
