"""Where the arm and the shelf stand; the world is the shelf's frame (`robots.shelf_tool`).

The shelf is open at its front, y = 0, and stands on a cabinet. Beside it, to its left and level
with its floor, a counter takes what is handed over.
"""

from dataclasses import dataclass
from math import pi

import numpy as np

from robots.descriptions.kinova import BLADE_LENGTH_M, CAMERA_M, CUP_AHEAD_M
from robots.interfaces import Floats
from robots.placement import Placement, PlanningScene, StaticBox

BOARD_M = 0.018
# Shoulder a little below the shelf's floor and far enough back that the arm is not folded up when
# it looks from before the shelf, nor stretched at its back corners.
BASE_BEFORE_M, BASE_BELOW_M = 0.62, 0.45
_CABINET_HEIGHT_M = 0.73
_COUNTER_WIDTH_M, _COUNTER_GAP_M = 0.36, 0.03

ROBOT = "kinova_j2s7s300"
# The camera before the middle of the shelf, elbow up.
HOME_RAD: Floats = np.radians([-6.4, 272.6, 174.0, 86.4, 6.1, 269.7, -6.1])

# A level tool that looks into the shelf: x along the shelf, y down, z into it.
LEVEL_TOOL: Floats = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
# The camera in the suction frame: above the blade, behind its tip.
T_TIP_CAMERA: Floats = np.eye(4)
T_TIP_CAMERA[:3, 3] = CAMERA_M - np.array([0.0, 0.0, BLADE_LENGTH_M + CUP_AHEAD_M])


@dataclass(frozen=True, slots=True)
class ShelfSize:
    """The inside of the shelf.

    Attributes:
        width_m: Along x.
        depth_m: Along y.
        height_m: Along z.
    """

    width_m: float = 0.8
    depth_m: float = 0.35
    height_m: float = 0.57


def arm_placement(shelf: ShelfSize) -> Placement:
    """Return where the arm's root stands: before the middle of the shelf, facing it."""
    return Placement((0.5 * shelf.width_m, -BASE_BEFORE_M, -BASE_BELOW_M), 0.5 * pi)


def boards(shelf: ShelfSize) -> tuple[StaticBox, ...]:
    """Return the shelf's boards and walls, the cabinet under it and the counter beside it."""
    width, depth, height, board = shelf.width_m, shelf.depth_m, shelf.height_m, BOARD_M
    middle_x, middle_y, middle_z = 0.5 * width, 0.5 * depth, 0.5 * height
    outer = width + 2.0 * board
    return (
        StaticBox("shelf_floor", (middle_x, middle_y, -0.5 * board), (outer, depth, board)),
        StaticBox("shelf_top", (middle_x, middle_y, height + 0.5 * board), (outer, depth, board)),
        StaticBox("left_wall", (-0.5 * board, middle_y, middle_z), (board, depth, height)),
        StaticBox("right_wall", (width + 0.5 * board, middle_y, middle_z), (board, depth, height)),
        StaticBox(
            "shelf_back",
            (middle_x, depth + 0.5 * board, middle_z),
            (outer, board, height + 2.0 * board),
        ),
        StaticBox(
            "cabinet",
            (middle_x, middle_y, -board - 0.5 * _CABINET_HEIGHT_M),
            (outer, depth, _CABINET_HEIGHT_M),
        ),
        StaticBox("counter", counter_middle(shelf), (_COUNTER_WIDTH_M, depth, board)),
    )


def counter_middle(shelf: ShelfSize) -> tuple[float, float, float]:
    """Return the centre of the counter's slab; its upper face is level with the shelf's floor."""
    x_m = -BOARD_M - _COUNTER_GAP_M - 0.5 * _COUNTER_WIDTH_M
    return (x_m, 0.5 * shelf.depth_m, -0.5 * BOARD_M)


def open_scene(shelf: ShelfSize) -> PlanningScene:
    """Return the scene in which tools may go into the shelf."""
    return PlanningScene(arm_placement(shelf), boards(shelf))


def closed_scene(shelf: ShelfSize) -> PlanningScene:
    """Return the scene for free motions: whatever may stand in the shelf, they stay out."""
    size = (shelf.width_m, shelf.depth_m, shelf.height_m)
    inside = StaticBox("shelf_contents", (0.5 * size[0], 0.5 * size[1], 0.5 * size[2]), size)
    return PlanningScene(arm_placement(shelf), (*boards(shelf), inside))
