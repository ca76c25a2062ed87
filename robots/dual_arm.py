"""Two arms as skills use them: `robots.interfaces.DualArm` over any driver."""

from collections.abc import Mapping

from robots.interfaces import (
    ARMS,
    Arm,
    ArmName,
    ArmsDriver,
    Floats,
    Goal,
    Grip,
    MotionFailure,
    TcpGoal,
    Trajectory,
)
from robots.motion.model import yumi_model
from robots.motion.planner import PlannerSettings
from robots.placement import HOME_RAD, PlanningScene, table_scene
from robots.planned import PlannedMotions, one_at_a_time


class PlannedDualArm(PlannedMotions):
    """Plans with a model of the YuMi, hands checked trajectories to a driver."""

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
        scene = scene or table_scene()
        super().__init__(driver, yumi_model(scene.placement), scene, HOME_RAD, seed, settings)
        self._grippers = driver

    @one_at_a_time
    def plan(self, goals: Mapping[ArmName, Goal]) -> Trajectory | MotionFailure:
        """Plan a free motion that takes each named arm to its goal; the others stay."""
        start = self._rest()
        if isinstance(start, MotionFailure):
            return start
        return self._planner.to_goals(start, goals)

    @one_at_a_time
    def plan_at_own_pace(self, goals: Mapping[ArmName, Goal]) -> Trajectory | MotionFailure:
        """Plan a free motion in which each arm takes the time that it needs alone.

        The arms are checked against each other at every moment; one may have to start later.
        """
        start = self._rest()
        if isinstance(start, MotionFailure):
            return start
        return self._planner.at_own_pace(start, goals)

    @one_at_a_time
    def plan_line(self, displacements_m: Mapping[ArmName, Floats]) -> Trajectory | MotionFailure:
        """Plan straight tool motions from the present poses, in step, orientation kept."""
        start = self._rest()
        if isinstance(start, MotionFailure):
            return start
        return self._planner.along_lines(start, displacements_m)

    @one_at_a_time
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

    @one_at_a_time
    def reachable(self, arm: Arm, goal: TcpGoal) -> bool:
        """Return whether that arm alone could reach the goal without collision."""
        present = self._note_state()
        return self._planner.solver.reaches(arm, goal, present)

    def tcp_position(self, arm: Arm) -> Floats:
        """Return the present position of a tool centre point in the world [m], shape (3,)."""
        positions = self._driver.state().positions_rad
        return self.robot.tcp_pose(arm, positions).translation.copy()

    def moving(self) -> bool:
        """Return whether a motion or a gripper is still under way."""
        return super().moving() or self._gripping()

    def resting(self) -> bool:
        """Return whether nothing moves: no motion is under way, or it is held."""
        return super().resting() and not self._gripping()

    def grip(self, arm: Arm, grip: Grip) -> None:
        """Start opening or closing a gripper."""
        self._grippers.grip(arm, grip)

    def holds(self, arm: Arm) -> bool:
        """Return whether something is between the fingers."""
        return self._grippers.holds(arm)

    def _gripping(self) -> bool:
        return any(self._grippers.gripping(arm) for arm in ARMS)
