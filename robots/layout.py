"""Whether a table can be worked on from where the YuMi stands: who reaches what of it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robots.interfaces import ARMS, Floats
from robots.motion.collision import CollisionModel
from robots.motion.model import yumi_model
from robots.placement import (
    HOME_RAD,
    REACH_OF_BOTH,
    REACH_OF_ONE,
    TABLE_SIZE_M,
    PlanningScene,
    Rectangle,
)
from robots.reach import ReachMap, reach_map

GRASP_HEIGHT_M, ABOVE_M = 0.008, 0.06
# With less of its work area in reach, most cables lie where no hand gets to.
LEAST_WORK_SHARE = 0.9


@dataclass(frozen=True, slots=True, eq=False)
class LayoutReport:
    """What a layout is worth.

    Attributes:
        reach: Who grasps where, over a grid of the table.
        seen: What the camera sees of the table.
        warnings: What does not fit together, a sentence each, with what to try.
        works: Whether missions can be done at all.
    """

    reach: ReachMap
    seen: Rectangle
    warnings: tuple[str, ...]
    works: bool

    def shares(self) -> dict[str, float]:
        """Return which share of the table each arm grasps at, then one of them, then both."""
        reached = self.reach.reached()
        masks = {**reached, "one": _any(reached), "both": _all(reached)}
        return {name: float(mask.mean()) for name, mask in masks.items()}


def judge_layout(scene: PlanningScene, seen: Rectangle, step_m: float) -> LayoutReport:
    """Measure who reaches what on the table, and say what is amiss.

    Args:
        scene: Where the robot stands, and the table.
        seen: What the camera sees.
        step_m: Of the grid.
    """
    x_m, y_m = (_grid(0.5 * size, step_m) for size in TABLE_SIZE_M)
    down = (np.array([0.0, 0.0, -ABOVE_M]),)
    reach = reach_map(scene, x_m, y_m, height_m=GRASP_HEIGHT_M + ABOVE_M, yaws=2, onward_m=down)
    faults = [*_home_faults(scene), *_reach_faults(reach)]
    return LayoutReport(reach, seen, (*faults, *_hints(reach, seen)), not faults)


def _grid(half_m: float, step_m: float) -> Floats:
    count = int(half_m / step_m)
    grid: Floats = np.arange(-count, count + 1, dtype=np.float64) * step_m
    return grid


def _home_faults(scene: PlanningScene) -> list[str]:
    collision = CollisionModel(yumi_model(scene.placement), scene)
    collision.set_openings(dict.fromkeys(ARMS, 0.05))
    pair = collision.colliding_pair(HOME_RAD)
    if pair is None:
        return []
    return [
        f"at home, {pair[0]} and {pair[1]} collide: no mission can begin; try moving the robot "
        "away from the table, or the table down"
    ]


def _reach_faults(reach: ReachMap) -> list[str]:
    reached = reach.reached()
    faults = []
    work = _inside(reach, REACH_OF_ONE)
    done = float(_any(reached)[work].mean())
    if done < LEAST_WORK_SHARE:
        faults.append(
            f"{100 * done:.0f} % of the work area {_words(REACH_OF_ONE)} can be grasped; expected "
            f"{100 * LEAST_WORK_SHARE:.0f} % or more; try moving the robot nearer to the table, "
            "or the table's surface 0 to 0.10 m above the body's frame"
        )
    if not _all(reached)[_inside(reach, REACH_OF_BOTH)].any():
        faults.append(
            f"no place in {_words(REACH_OF_BOTH)} is reached by both arms: knots cannot be dilated"
        )
    return faults


def _hints(reach: ReachMap, seen: Rectangle) -> list[str]:
    hints = []
    work = _inside(reach, REACH_OF_ONE)
    unseen = work & ~_inside(reach, seen)
    if unseen.any():
        hints.append(
            f"the camera sees {_words(seen)}, not all of the work area {_words(REACH_OF_ONE)}; try "
            "a larger camera.scale_m_px"
        )
    idle = [arm for arm, mask in reach.reached().items() if not mask[work].any()]
    hints += [f"the {arm} arm reaches nothing of the work area" for arm in idle]
    return hints


def _inside(reach: ReachMap, rectangle: Rectangle) -> NDArray[np.bool_]:
    (x0, y0), (x1, y1) = rectangle.low_m, rectangle.high_m
    columns = (reach.x_m >= x0 - 1e-9) & (reach.x_m <= x1 + 1e-9)
    rows = (reach.y_m >= y0 - 1e-9) & (reach.y_m <= y1 + 1e-9)
    return rows[:, None] & columns[None]


def _any(masks: dict[str, NDArray[np.bool_]]) -> NDArray[np.bool_]:
    return np.logical_or.reduce(list(masks.values()))


def _all(masks: dict[str, NDArray[np.bool_]]) -> NDArray[np.bool_]:
    return np.logical_and.reduce(list(masks.values()))


def _words(rectangle: Rectangle) -> str:
    (x0, y0), (x1, y1) = rectangle.low_m, rectangle.high_m
    return f"x {x0:.2f} to {x1:.2f} m, y {y0:.2f} to {y1:.2f} m"
