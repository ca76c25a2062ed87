"""Where the robot stands and what stands around it: what a cell tells the planner.

World frame as in `robots.interfaces`: origin at the table's centre, z = 0 on its surface.
"""

from dataclasses import dataclass
from math import pi

from robots.descriptions.model import Vec3

TABLE_SIZE_M = (1.0, 0.75)
# Thin enough that the robot's feet (their top is 40 mm below the table's surface) fit under it.
TABLE_THICKNESS_M = 0.03


@dataclass(frozen=True, slots=True)
class Placement:
    """Where the root of a robot stands: a position and a turn about the vertical."""

    position_m: Vec3
    yaw_rad: float


@dataclass(frozen=True, slots=True)
class StaticBox:
    """An axis-aligned box that never moves, in the world frame.

    Attributes:
        name: Shown in reports of collisions.
        centre_m: Middle of the box [m].
        size_m: Whole edge lengths [m].
    """

    name: str
    centre_m: Vec3
    size_m: Vec3


@dataclass(frozen=True, slots=True)
class PlanningScene:
    """The robot's placement and the static boxes that it must not touch."""

    placement: Placement
    boxes: tuple[StaticBox, ...] = ()


YUMI_AT_TABLE = Placement(position_m=(0.0, -0.425, -0.10), yaw_rad=pi / 2)


def table_top(
    size_m: tuple[float, float] = TABLE_SIZE_M, thickness_m: float = TABLE_THICKNESS_M
) -> StaticBox:
    """Return the table's slab; its upper face is z = 0 and its centre the world's origin."""
    return StaticBox("table", (0.0, 0.0, -thickness_m / 2), (*size_m, thickness_m))


def table_scene() -> PlanningScene:
    """Return the YuMi at the long side of the table, looking along +y."""
    return PlanningScene(YUMI_AT_TABLE, (table_top(),))
