"""One arm with a tool as skills use it: `robots.interfaces.SingleArm` over any driver."""

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from executive.core.errors import InputError
from robots.descriptions.specs import RobotSpec
from robots.interfaces import Floats, Goal, JointsDriver, MotionFailure, Trajectory
from robots.motion.model import RobotModel
from robots.motion.planner import PlannerSettings
from robots.placement import AttachedBox, PlanningScene, StaticBox
from robots.planned import PlannedMotions, one_at_a_time


class PlannedArm(PlannedMotions):
    """Plans with a model of a robot of one arm, hands checked trajectories to a driver."""

    def __init__(
        self,
        driver: JointsDriver,
        spec: RobotSpec,
        scene: PlanningScene,
        home_rad: Floats,
        *,
        seed: int,
        settings: PlannerSettings | None = None,
    ) -> None:
        """Bind a driver; nothing moves.

        Args:
            driver: Controllers of the joints.
            spec: The robot, such as `robots.descriptions.specs.kinova_spec(7)`.
            scene: Where it stands, and the boxes around it.
            home_rad: The ready pose, shape (n,).
            seed: Of everything random in planning.
            settings: Effort and speed of plans.

        Raises:
            InputError: The robot has not exactly one arm.
        """
        if len(spec.arms) != 1:
            raise InputError(
                f"{spec.name}: got {len(spec.arms)} arms; expected one; "
                "try robots.dual_arm.PlannedDualArm"
            )
        robot = RobotModel(spec, scene.placement)
        super().__init__(driver, robot, scene, home_rad, seed, settings)
        (self._arm,) = robot.arms
        self._scene = scene

    @property
    def scene(self) -> PlanningScene:
        """What stands around the robot, and what it carries."""
        return self._scene

    @one_at_a_time
    def plan(self, goal: Goal) -> Trajectory | MotionFailure:
        """Plan a free motion that takes the tool to a goal."""
        start = self._rest()
        if isinstance(start, MotionFailure):
            return start
        return self._planner.to_goals(start, {self._arm: goal})

    @one_at_a_time
    def plan_line(self, displacement_m: Floats) -> Trajectory | MotionFailure:
        """Plan a straight tool motion from the present pose, orientation kept.

        Args:
            displacement_m: In the world [m], shape (3,).
        """
        start = self._rest()
        if isinstance(start, MotionFailure):
            return start
        return self._planner.along_lines(start, {self._arm: displacement_m})

    @one_at_a_time
    def plan_configuration(self, positions_rad: Floats) -> Trajectory | MotionFailure:
        """Plan a motion to joint positions of shape (n,)."""
        return self._plan_to(positions_rad)

    @one_at_a_time
    def reachable(self, goal: Goal) -> bool:
        """Return whether the goal could be reached without collision."""
        return self._planner.solver.reaches(self._arm, goal, self._note_state())

    @one_at_a_time
    def set_obstacles(self, boxes: Sequence[StaticBox]) -> None:
        """Replace the boxes that stand around the robot in all later plans."""
        self._take_scene(PlanningScene(self._scene.placement, tuple(boxes), self._scene.attached))

    @one_at_a_time
    def attach(self, box: StaticBox, margin_m: float = 0.002) -> None:
        """Carry a box, from where it is now, in all later plans.

        Args:
            box: Its pose now; one of that name in the scene is no obstacle any more.
                `touched_by` names links and boxes that it may touch, such as the cup.
            margin_m: How far it keeps from all else [m].
        """
        T_world_box = pin.XYZQUATToSE3(np.array([*box.centre_m, *box.quat_xyzw]))
        row = pin.SE3ToXYZQUAT(self._T_world_tcp().actInv(T_world_box)).tolist()
        carried = AttachedBox(
            box.name,
            self._arm,
            tuple(row[:3]),
            box.size_m,
            tuple(row[3:]),
            box.touched_by,
            margin_m,
        )
        others = tuple(other for other in self._scene.boxes if other.name != box.name)
        self._take_scene(PlanningScene(self._scene.placement, others, (carried,)))

    @one_at_a_time
    def detach(self) -> None:
        """Leave what is carried where it is now: it is an obstacle in all later plans."""
        left = []
        for box in self._scene.attached:
            T_tcp_box = pin.XYZQUATToSE3(np.array([*box.centre_m, *box.quat_xyzw]))
            row = pin.SE3ToXYZQUAT(self._T_world_tcp() * T_tcp_box).tolist()
            left.append(
                StaticBox(box.name, tuple(row[:3]), box.size_m, tuple(row[3:]), box.touched_by)
            )
        self._take_scene(PlanningScene(self._scene.placement, (*self._scene.boxes, *left)))

    def tcp_pose(self) -> tuple[Floats, Floats]:
        """Return position [m] and quaternion xyzw of the tool in the world, now."""
        row = pin.SE3ToXYZQUAT(self._T_world_tcp())
        return np.array(row[:3]), np.array(row[3:])

    def _T_world_tcp(self) -> pin.SE3:
        return self.robot.tcp_pose(self._arm, self._driver.state().positions_rad)

    def _take_scene(self, scene: PlanningScene) -> None:
        self._planner.set_scene(scene)
        self._scene = scene
