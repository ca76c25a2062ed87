"""Who reaches what: which parts of the table each arm can grasp at, measured with the solver."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from robots.interfaces import Floats, TcpGoal
from robots.motion.model import yumi_model
from robots.motion.solver import GoalSolver
from robots.placement import HOME_RAD, PlanningScene


@dataclass(frozen=True, slots=True, eq=False)
class ReachMap:
    """Share of the yaws at which each arm can grasp, over a grid of the table.

    Attributes:
        x_m: Columns, in the world [m], shape (w,).
        y_m: Rows, in the world [m], shape (h,).
        share: For each arm an array in [0, 1], shape (h, w).
    """

    x_m: Floats
    y_m: Floats
    share: Mapping[str, Floats]

    def reached(self, least_share: float = 1.0) -> dict[str, NDArray[np.bool_]]:
        """Return for each arm where it grasps at that share of the yaws or more."""
        return {arm: share >= least_share - 1e-9 for arm, share in self.share.items()}

    def rows(self) -> list[str]:
        """Return one line of text a row, the farthest first: L, R, B(oth) or a point."""
        marks = np.array([".", "L", "R", "B"])
        reached = self.reached()
        codes = reached["left"].astype(int) + 2 * reached["right"].astype(int)
        return [
            f"{y:6.2f} {''.join(row)}"
            for y, row in zip(self.y_m[::-1], marks[codes][::-1], strict=True)
        ]


def reach_map(
    scene: PlanningScene,
    x_m: Floats,
    y_m: Floats,
    *,
    height_m: float = 0.01,
    yaws: int = 4,
    max_tilt_rad: float = 0.52,
    onward_m: tuple[Floats, ...] = (),
    seed: int = 0,
) -> ReachMap:
    """Measure where the YuMi's arms can grasp, each alone, with open grippers.

    Args:
        scene: Where the robot stands, and what is around it.
        x_m: Columns of the grid, in the world [m].
        y_m: Rows of the grid, in the world [m].
        height_m: Of the tool centre point over the table.
        yaws: Directions of opening that are tried, evenly over half a turn.
        max_tilt_rad: How far the hand may lean.
        onward_m: Straight motions that must be possible from there [m].
        seed: Of the solver.
    """
    robot = yumi_model(scene.placement)
    solver = GoalSolver(robot, scene, HOME_RAD, seed)
    solver.set_openings(dict.fromkeys(robot.arms, 0.05))
    share: dict[str, Floats] = {}
    for arm in robot.arms:
        share[arm] = np.zeros((len(y_m), len(x_m)))
        for row, column in np.ndindex(share[arm].shape):
            position_m = np.array([x_m[column], y_m[row], height_m])
            hits = [
                solver.reaches(arm, TcpGoal(position_m, yaw, max_tilt_rad, onward_m), HOME_RAD)
                for yaw in np.arange(yaws) * (pi / yaws)
            ]
            share[arm][row, column] = np.mean(hits)
    return ReachMap(x_m, y_m, share)
