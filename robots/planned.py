"""What planned motions of any robot share: planning by one thread at a time, and its driver."""

import threading
from collections.abc import Callable
from functools import wraps
from typing import Concatenate, ParamSpec, TypeVar

import numpy as np
from pydantic import JsonValue

from executive.core.errors import InputError
from robots.interfaces import Floats, JointsDriver, MotionFailure, Trajectory
from robots.motion.model import RobotModel
from robots.motion.planner import MotionPlanner, PlannerSettings
from robots.placement import PlanningScene

P = ParamSpec("P")
T = TypeVar("T")
S = TypeVar("S", bound="PlannedMotions")


def one_at_a_time(method: Callable[Concatenate[S, P], T]) -> Callable[Concatenate[S, P], T]:
    """Let threads use the planner one after the other."""

    @wraps(method)
    def guarded(self: S, /, *args: P.args, **kwargs: P.kwargs) -> T:
        with self.planning:
            return method(self, *args, **kwargs)

    return guarded


class PlannedMotions:
    """Plans with a model of a robot, hands checked trajectories to a driver.

    Attributes:
        robot: The model.
        planning: Held while a plan is made: plans may be made in threads, and one that nobody
            waits for any more is still at it.
    """

    def __init__(
        self,
        driver: JointsDriver,
        robot: RobotModel,
        scene: PlanningScene,
        home_rad: Floats,
        seed: int,
        settings: PlannerSettings | None,
    ) -> None:
        """Bind a driver; nothing moves.

        Args:
            driver: Controllers of all joints.
            robot: The robot at its place.
            scene: What stands around it.
            home_rad: The ready pose, shape (n,).
            seed: Of everything random in planning.
            settings: Effort and speed of plans.
        """
        self._driver = driver
        self.robot = robot
        self._home_rad = home_rad
        self._planner = MotionPlanner(robot, scene, home_rad, seed, settings)
        self.planning = threading.RLock()

    @one_at_a_time
    def plan_home(self) -> Trajectory | MotionFailure:
        """Plan a motion to the ready pose."""
        return self._plan_to(self._home_rad)

    def start(self, trajectory: Trajectory) -> None:
        """Hand a planned trajectory to the driver."""
        self._driver.execute(trajectory)

    def moving(self) -> bool:
        """Return whether a motion is still under way."""
        return self._driver.state().moving

    def hold(self) -> None:
        """Bring a motion to rest on its own path, to be taken up again by `go_on`."""
        self._driver.hold()

    def go_on(self) -> None:
        """Take up a motion that was held."""
        self._driver.go_on()

    def resting(self) -> bool:
        """Return whether nothing moves: no motion is under way, or it is held."""
        return self._driver.held() or not self._driver.state().moving

    def stop(self) -> None:
        """Bring all joints to rest within their jerk limits; a held motion is given up."""
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

    def _plan_to(self, positions_rad: Floats) -> Trajectory | MotionFailure:
        start = self._rest()
        if isinstance(start, MotionFailure):
            return start
        return self._planner.to_configuration(start, positions_rad)

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
            return MotionFailure("motion.timing", "path", text, cause="moving")
        return self._note_state()
