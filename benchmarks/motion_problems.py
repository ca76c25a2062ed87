"""Motions among random boxes on the table, as pick motions are: from above, to above or down."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from robots.interfaces import ARMS, Arm, Floats, MotionFailure, TcpGoal
from robots.motion.model import RobotModel, yumi_model
from robots.motion.planner import MotionPlanner
from robots.placement import (
    HOME_RAD,
    REACH_OF_ONE,
    PlanningScene,
    Rectangle,
    StaticBox,
    table_scene,
)

BOXES = 5
BOX_SIZE_M = ((0.04, 0.04, 0.04), (0.10, 0.10, 0.22))
GOAL_HEIGHT_M = (0.02, 0.10)
OPENINGS_M: dict[Arm, float] = dict.fromkeys(ARMS, 0.05)
# Of two arms at once, each has its own half of the table.
HALVES: dict[Arm, Rectangle] = {
    "left": Rectangle((-0.40, -0.20), (-0.10, 0.12)),
    "right": Rectangle((0.10, -0.20), (0.40, 0.12)),
}


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """A motion to plan: arms go from one configuration to goals of their tools.

    Attributes:
        scene: What stands in the way.
        start_rad: Configuration of both arms, free of collisions, shape (14,).
        goals: Goals that can be reached, by arm.
        seed: Of the planner.
    """

    scene: PlanningScene
    start_rad: Floats
    goals: dict[Arm, TcpGoal]
    seed: int

    def planner(self) -> MotionPlanner:
        """Return a planner that knows the scene."""
        return planner_in(yumi_model(self.scene.placement), self.scene, self.seed)


def planner_in(robot: RobotModel, scene: PlanningScene, seed: int) -> MotionPlanner:
    """Return a planner of a robot with open hands."""
    planner = MotionPlanner(robot, scene, HOME_RAD, seed)
    planner.solver.set_openings(OPENINGS_M)
    return planner


def pick_problems(seed: int, arms: Sequence[Arm] | None) -> Iterator[Problem]:
    """Yield problems for ever; where nothing can be reached, or a start collides, is no problem.

    Args:
        seed: Of all of them.
        arms: Arms that move at once; None for one of both in turn.
    """
    number = 0
    while True:
        rng = np.random.default_rng([seed, number])
        moving = tuple(arms) if arms is not None else (ARMS[number % 2],)
        problem = _problem(rng, moving, number)
        number += 1
        if problem is not None:
            yield problem


def _problem(rng: np.random.Generator, arms: Sequence[Arm], seed: int) -> Problem | None:
    scene = _with_boxes(rng)
    planner = planner_in(yumi_model(scene.placement), scene, seed)
    if planner.solver.together.collides(HOME_RAD):
        return None
    start = planner.solver.configurations(_goals(rng, arms), HOME_RAD, 2)
    if isinstance(start, MotionFailure):
        return None
    goals = _goals(rng, arms)
    if isinstance(planner.solver.configurations(goals, start[0], 2), MotionFailure):
        return None
    return Problem(scene, start[0], goals, seed)


def _goals(rng: np.random.Generator, arms: Sequence[Arm]) -> dict[Arm, TcpGoal]:
    areas = HALVES if len(arms) > 1 else dict.fromkeys(arms, REACH_OF_ONE)
    return {
        arm: TcpGoal(
            np.append(
                rng.uniform(areas[arm].low_m, areas[arm].high_m), rng.uniform(*GOAL_HEIGHT_M)
            ),
            float(rng.uniform(0.0, np.pi)),
        )
        for arm in arms
    }


def _with_boxes(rng: np.random.Generator) -> PlanningScene:
    table = table_scene()
    boxes = []
    for number in range(BOXES):
        size = rng.uniform(*BOX_SIZE_M)
        x, y = rng.uniform(REACH_OF_ONE.low_m, REACH_OF_ONE.high_m)
        boxes.append(
            StaticBox(f"box {number}", (x, y, 0.5 * size[2] + 0.001), tuple(size.tolist()))
        )
    return PlanningScene(table.placement, (*table.boxes, *boxes))
