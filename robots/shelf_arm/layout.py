"""Whether an arm can work in the shelf that it stands before: what its tool reaches of it."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from robots.descriptions.specs import ARM, kinova_spec
from robots.interfaces import Floats, PoseGoal
from robots.motion.collision import CollisionModel
from robots.motion.model import RobotModel
from robots.motion.solver import GoalSolver
from robots.shelf_arm.scene import (
    HOME_RAD,
    LEVEL_TOOL,
    T_TIP_CAMERA,
    ShelfSize,
    closed_scene,
    open_scene,
)
from robots.shelf_arm.settings import ShelfArmSettings

Mask = NDArray[np.bool_]
# Blades push near the floor; cups take tall boxes near their tops.
LOW_M, HIGH_M = ShelfArmSettings().push_height_m, 0.20
LEAST_LOW_SHARE, LEAST_HIGH_SHARE = 0.9, 0.5
LEAST_SEEN_SHARE = 0.9
# How near to the walls and the back the middle of the tool is asked for.
_EDGE_M = 0.05
_MARKS = np.array([".", "o", "^", "#"])


@dataclass(frozen=True, slots=True, eq=False)
class ShelfReport:
    """What the place of an arm before a shelf is worth.

    Attributes:
        x_m: Columns of the grid, along the shelf [m], shape (w,).
        y_m: Rows of the grid, into it [m], shape (h,).
        low: Where the tool gets to on a straight line near the floor, shape (h, w).
        high: The same where it takes tall boxes.
        seen: What the cameras see of the floor of the empty shelf.
        viewpoints: Whether the arm can look from each viewpoint.
        warnings: What does not fit together, a sentence each.
        works: Whether missions can be done at all.
    """

    x_m: Floats
    y_m: Floats
    low: Mask
    high: Mask
    seen: Mask
    viewpoints: Mapping[str, bool]
    warnings: tuple[str, ...]
    works: bool

    def shares(self) -> dict[str, float]:
        """Return which share of the shelf is reached near the floor and higher up, and seen."""
        masks = {"low": self.low, "high": self.high, "seen": self.seen}
        return {name: float(mask.mean()) for name, mask in masks.items()}

    def rows(self) -> list[str]:
        """Return one line of text a row, the farthest first: # both heights, o low, ^ high."""
        marks = _MARKS[self.low.astype(int) + 2 * self.high.astype(int)]
        return [
            f"{y:6.2f} {''.join(row)}" for y, row in zip(self.y_m[::-1], marks[::-1], strict=True)
        ]


def shelf_grid(shelf: ShelfSize, step_m: float) -> tuple[Floats, Floats]:
    """Return columns and rows about that far apart over a shelf's floor [m]."""
    spans = ((_EDGE_M, shelf.width_m - _EDGE_M), (_EDGE_M, shelf.depth_m - _EDGE_M))
    x_m, y_m = (np.linspace(low, high, 1 + round((high - low) / step_m)) for low, high in spans)
    return x_m, y_m


def judge_shelf(
    shelf: ShelfSize, viewpoints: Mapping[str, Floats], seen: Mask, step_m: float, seed: int = 0
) -> ShelfReport:
    """Measure what of the empty shelf the Kinova's tool reaches, and say what is amiss.

    Args:
        shelf: The shelf; its frame is the world.
        viewpoints: T_shelf_camera by name, shape (4, 4).
        seen: What the cameras see of the floor, on the grid of `shelf_grid`.
        step_m: Of the grid.
        seed: Of the solver.
    """
    scene = open_scene(shelf)
    robot = RobotModel(kinova_spec(len(HOME_RAD)), scene.placement)
    solver = GoalSolver(robot, scene, HOME_RAD, seed)
    x_m, y_m = shelf_grid(shelf, step_m)
    low, high = (_reached(solver, x_m, y_m, height_m) for height_m in (LOW_M, HIGH_M))
    looks = {name: _looks(solver, T) for name, T in viewpoints.items()}
    pair = CollisionModel(robot, closed_scene(shelf)).colliding_pair(HOME_RAD)
    faults = [] if pair is None else [f"at home, {pair[0]} and {pair[1]} collide"]
    if low.mean() < LEAST_LOW_SHARE:
        faults.append(
            f"{100 * low.mean():.0f} % of the shelf is reached near its floor; expected "
            f"{100 * LEAST_LOW_SHARE:.0f} % or more"
        )
    if not any(looks.values()):
        faults.append("the camera reaches no viewpoint: nothing is seen")
    warnings = (*faults, *_hints(high, seen, looks))
    return ShelfReport(x_m, y_m, low, high, seen, looks, warnings, not faults)


def without_arm(
    shelf: ShelfSize, viewpoints: Mapping[str, Floats], seen: Mask, step_m: float
) -> ShelfReport:
    """Return the report of a shelf whose tool moves by itself: it gets everywhere."""
    x_m, y_m = shelf_grid(shelf, step_m)
    everywhere = np.ones((len(y_m), len(x_m)), dtype=bool)
    looks = dict.fromkeys(viewpoints, True)
    hints = tuple(_hints(everywhere, seen, looks))
    return ShelfReport(x_m, y_m, everywhere, everywhere, seen, looks, hints, works=True)


def _reached(solver: GoalSolver, x_m: Floats, y_m: Floats, height_m: float) -> Mask:
    """Say where the tool gets to on a line from before the shelf."""
    before_m = ShelfArmSettings().before_m
    quat_xyzw = Rotation.from_matrix(LEVEL_TOOL).as_quat()
    reached = np.zeros((len(y_m), len(x_m)), dtype=bool)
    for row, column in np.ndindex(reached.shape):
        start_m = np.array([x_m[column], -before_m, height_m])
        into_m = np.array([0.0, y_m[row] + before_m, 0.0])
        goal = PoseGoal(start_m, quat_xyzw, onward_m=(into_m,))
        reached[row, column] = solver.reaches(ARM, goal, HOME_RAD)
    return reached


def _looks(solver: GoalSolver, T_shelf_camera: Floats) -> bool:
    T_shelf_tip = T_shelf_camera @ np.linalg.inv(T_TIP_CAMERA)
    quat_xyzw = Rotation.from_matrix(T_shelf_tip[:3, :3]).as_quat()
    return solver.reaches(ARM, PoseGoal(T_shelf_tip[:3, 3], quat_xyzw), HOME_RAD)


def _hints(high: Mask, seen: Mask, looks: Mapping[str, bool]) -> list[str]:
    hints = []
    if high.mean() < LEAST_HIGH_SHARE:
        hints.append(
            f"{100 * high.mean():.0f} % of the shelf is reached {HIGH_M:.2f} m above its floor; "
            "tall boxes elsewhere cannot be taken near their tops"
        )
    if seen.mean() < LEAST_SEEN_SHARE:
        hints.append(
            f"the camera sees {100 * seen.mean():.0f} % of the floor of the empty shelf from its "
            "viewpoints"
        )
    hints += [
        f"the camera does not reach the viewpoint {name}" for name, ok in looks.items() if not ok
    ]
    return hints
