"""What a robot description is made of: links, joints and primitive shapes, as plain data.

One description feeds the collision model, the simulator and the viewer, by way of one URDF
(`robots.descriptions.urdf`). Angles are in radians, lengths in metres, rpy is URDF's fixed-axis
roll-pitch-yaw.
"""

from dataclasses import dataclass
from typing import Literal

Vec3 = tuple[float, float, float]
Rgba = tuple[float, float, float, float]
ZERO: Vec3 = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Capsule:
    """All points within `radius_m` of a segment, in the link's frame [m]."""

    start_m: Vec3
    end_m: Vec3
    radius_m: float


@dataclass(frozen=True, slots=True)
class Box:
    """An axis-aligned box between two corners, in the link's frame [m]."""

    low_m: Vec3
    high_m: Vec3


Shape = Capsule | Box


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of a joint in [rad, rad/s] or, when prismatic, in [m, m/s]."""

    lower: float
    upper: float
    velocity: float
    effort: float


@dataclass(frozen=True, slots=True)
class Link:
    """A rigid body; its shapes serve collision and looks alike.

    Attributes:
        name: Unique in the robot.
        mass_kg: Mass; every link has one, since PyBullet gives a link without 1 kg.
        shapes: Primitives that enclose the body.
        colour: Red, green, blue, alpha in [0, 1].
    """

    name: str
    mass_kg: float
    shapes: tuple[Shape, ...] = ()
    colour: Rgba = (0.86, 0.86, 0.84, 1.0)


@dataclass(frozen=True, slots=True)
class Joint:
    """Places a child link in its parent's frame and lets it move along or about an axis.

    Attributes:
        name: Unique in the robot.
        kind: URDF's joint type.
        parent: Name of the parent link.
        child: Name of the child link.
        xyz_m: Origin of the child in the parent's frame [m].
        rpy_rad: Orientation of the child in the parent's frame [rad].
        axis: Unit vector in the child's frame.
        limits: Of a joint that moves.
    """

    name: str
    kind: Literal["fixed", "revolute", "prismatic"]
    parent: str
    child: str
    xyz_m: Vec3 = ZERO
    rpy_rad: Vec3 = ZERO
    axis: Vec3 = (0.0, 0.0, 1.0)
    limits: Limits | None = None


@dataclass(frozen=True, slots=True)
class RobotDescription:
    """A tree of links; the first link is the root."""

    name: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
