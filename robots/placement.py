"""Where the robot stands and what stands around it: what a cell tells the planner.

World frame as in `robots.interfaces`: origin at the table's centre, z = 0 on its surface.
"""

from dataclasses import dataclass
from math import pi

import numpy as np

from robots.descriptions.model import Vec3
from robots.interfaces import Floats

Quat = tuple[float, float, float, float]
UPRIGHT: Quat = (0.0, 0.0, 0.0, 1.0)
TABLE_SIZE_M = (1.0, 0.75)
# Thin enough that the robot's feet (their top is 40 mm below the table's surface) fit under it.
TABLE_THICKNESS_M = 0.03
# A knot is three strands high at most; grippers come down from twice as high.
CABLE_ROOM_M = 0.03


# The ready pose: elbows out, hands beside the table. Seen from 1.2 m above the table's centre,
# nothing of the robot shows above y = -0.33. The left arm is the right one mirrored.
_HOME_RIGHT_DEG = np.array([0.0, -52.0, -79.0, 13.0, 0.0, 25.0, 0.0])
_MIRROR = np.array([-1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
HOME_RAD: Floats = np.radians(np.concatenate([_MIRROR * _HOME_RIGHT_DEG, _HOME_RIGHT_DEG]))


@dataclass(frozen=True, slots=True)
class Rectangle:
    """Part of the table between two corners, in the world [m]."""

    low_m: tuple[float, float]
    high_m: tuple[float, float]

    def contains(self, position_m: Floats) -> bool:
        """Return whether the first two coordinates of a point lie in it."""
        low, high = np.array(self.low_m), np.array(self.high_m)
        return bool(np.all((position_m[:2] >= low) & (position_m[:2] <= high)))


# Where grasps succeed at every yaw, from 6 cm above straight down to 8 mm, leaning up to 30
# degrees: by one arm or the other, and by either arm. Measured with `robots.reach.reach_map`
# every 5 cm.
REACH_OF_ONE = Rectangle((-0.40, -0.20), (0.40, 0.15))
REACH_OF_BOTH = Rectangle((-0.25, -0.15), (0.25, 0.10))


@dataclass(frozen=True, slots=True)
class Placement:
    """Where the root of a robot stands: a position and a turn about the vertical."""

    position_m: Vec3
    yaw_rad: float


@dataclass(frozen=True, slots=True)
class StaticBox:
    """A box that never moves while the robot does, in the world frame.

    Attributes:
        name: Shown in reports of collisions.
        centre_m: Middle of the box [m].
        size_m: Whole edge lengths [m].
        quat_xyzw: Orientation; edges lie along the world's axes by default.
        touched_by: Links that may touch it, as a blade does the box that it pushes.
    """

    name: str
    centre_m: Vec3
    size_m: Vec3
    quat_xyzw: Quat = UPRIGHT
    touched_by: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class AttachedBox:
    """A box that an arm carries.

    Attributes:
        name: Shown in reports of collisions.
        arm: Which arm carries it.
        centre_m: Middle of the box in the tool's frame [m].
        size_m: Whole edge lengths [m].
        quat_xyzw: Orientation in the tool's frame.
        touched_by: Links, boxes of the scene besides, that it may touch: the cup that holds it.
        margin_m: How far it keeps from all else [m].
    """

    name: str
    arm: str
    centre_m: Vec3
    size_m: Vec3
    quat_xyzw: Quat = UPRIGHT
    touched_by: tuple[str, ...] = ()
    margin_m: float = 0.002


@dataclass(frozen=True, slots=True)
class PlanningScene:
    """What a robot moves among.

    Attributes:
        placement: Where it stands.
        boxes: What it must not touch.
        attached: What it carries.
        kept_clear: Room of loose things, which arms that come by would sweep away: free motions
            keep out of it that can, and begin and end outside.
    """

    placement: Placement
    boxes: tuple[StaticBox, ...] = ()
    attached: tuple[AttachedBox, ...] = ()
    kept_clear: tuple[StaticBox, ...] = ()


YUMI_AT_TABLE = Placement(position_m=(0.0, -0.425, -0.10), yaw_rad=pi / 2)


def table_top(
    size_m: tuple[float, float] = TABLE_SIZE_M, thickness_m: float = TABLE_THICKNESS_M
) -> StaticBox:
    """Return the table's slab; its upper face is z = 0 and its centre the world's origin."""
    return StaticBox("table", (0.0, 0.0, -thickness_m / 2), (*size_m, thickness_m))


def room_of_cable(size_m: tuple[float, float] = TABLE_SIZE_M) -> StaticBox:
    """Return the room over the table in which cable lies, knots and all."""
    centre_m = (0.0, 0.0, 0.5 * CABLE_ROOM_M)
    return StaticBox("room of the cable", centre_m, (*size_m, CABLE_ROOM_M))


def table_scene(placement: Placement = YUMI_AT_TABLE) -> PlanningScene:
    """Return the YuMi at the long side of the table, looking along +y."""
    return PlanningScene(placement, (table_top(),), kept_clear=(room_of_cable(),))
