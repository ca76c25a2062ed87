"""The Kinova Gen2 (JACO2) with a spherical wrist, seven or six joints, and the bluction tool.

Kinematic facts are those of Kinova's public description (BSD-3-Clause); shapes are capsules and
boxes of our own that enclose the links. Joints that the maker calls continuous are given two
turns either way, so that a configuration has one number a joint.

The bluction tool is a blade to push with and suction to lift with (Huang et al. 2022). No model of
it is public: this one is drawn to that purpose, as long as a shelf is deep. Its cups are small and
stand above each other on the blade's edge, so that the tool goes in where its blade does.
"""

from dataclasses import dataclass
from itertools import pairwise
from math import pi, radians

from robots.descriptions.model import Box, Capsule, Joint, Limits, Link, RobotDescription, Vec3

TWO_TURNS_DEG = 360.0
# From the last joint but five, the shoulder, to the end effector, over random configurations.
REACH_M = 0.985
BLADE_LENGTH_M, BLADE_HEIGHT_M, BLADE_THICKNESS_M = 0.35, 0.07, 0.006
CUP_RADIUS_M, CUP_AHEAD_M = 0.005, 0.012
# Where the cups are along y of the suction frame [m]; y points down while the blade is upright.
CUPS_M = (-0.024, -0.008, 0.008, 0.024)
# The camera's frame in the end effector's: above the blade, so that it sees what that touches.
CAMERA_M: Vec3 = (0.0, -0.085, 0.013)
_CAPSULE_ALLOWANCE_M = 0.001  # the fits let mesh vertices stick out by up to 0.57 mm

SUCTION_FRAME, BLADE_FRAME, CAMERA_FRAME = "suction", "blade", "tool_camera"

_BLACK = (0.13, 0.13, 0.14, 1.0)
_GREY = (0.35, 0.36, 0.38, 1.0)
_ORANGE = (0.90, 0.45, 0.12, 1.0)
_RUBBER = (0.20, 0.25, 0.45, 1.0)

_Fit = tuple[Vec3, Vec3, float]
_BASE: _Fit = ((0.0004, 0.0001, 0.0346), (-0.0004, 0.0021, 0.1345), 0.0488)
_SHOULDER: _Fit = ((0.0, -0.0139, -0.1188), (0.0001, 0.0, -0.0153), 0.044)
_ARM: _Fit = ((0.0001, -0.4102, -0.015), (0.0003, 0.0031, -0.015), 0.0436)
_ARM_HALF_1: _Fit = ((0.0, -0.19, 0.0002), (0.0001, 0.0001, -0.0152), 0.0438)
_ARM_HALF_2: _Fit = ((-0.0001, 0.0002, -0.0146), (-0.0001, 0.0154, -0.2052), 0.0438)
_FOREARM: _Fit = ((0.0001, 0.0002, -0.0153), (-0.0007, 0.177, -0.0112), 0.0441)
_WRIST_1: _Fit = ((0.0001, 0.0, -0.0161), (0.0, 0.0167, -0.1039), 0.0353)
_WRIST_2: _Fit = ((0.0001, 0.0882, 0.0008), (0.0001, -0.0003, -0.0166), 0.0354)
_HAND: _Fit = ((0.0007, -0.0002, -0.0476), (-0.0002, -0.0023, -0.0792), 0.0575)


@dataclass(frozen=True, slots=True)
class _Axis:
    """One joint and the link that it moves.

    Attributes:
        xyz_m: Origin in the parent link.
        rpy_rad: Orientation in the parent link.
        range_deg: Lower and upper position.
        speed_deg_s: Highest speed.
        effort_nm: Highest torque.
        fit: Capsule of the link.
        mass_kg: Its mass.
    """

    xyz_m: Vec3
    rpy_rad: Vec3
    range_deg: tuple[float, float]
    speed_deg_s: float
    effort_nm: float
    fit: _Fit
    mass_kg: float


_FREE = (-TWO_TURNS_DEG, TWO_TURNS_DEG)
_UPPER = (47.0, 313.0)
_BOTTOM = _Axis((0.0, 0.0, 0.15675), (0.0, pi, 0.0), _FREE, 36.0, 40.0, _SHOULDER, 0.748)

_SEVEN = (
    _BOTTOM,
    _Axis((0.0, 0.0016, -0.11875), (-pi / 2, 0.0, pi), _UPPER, 36.0, 80.0, _ARM_HALF_1, 0.845),
    _Axis((0.0, -0.205, 0.0), (-pi / 2, 0.0, 0.0), _FREE, 36.0, 40.0, _ARM_HALF_2, 0.845),
    _Axis((0.0, 0.0, -0.205), (pi / 2, 0.0, pi), (30.0, 330.0), 36.0, 40.0, _FOREARM, 0.676),
    _Axis((0.0, 0.2073, -0.0114), (-pi / 2, 0.0, pi), _FREE, 48.0, 20.0, _WRIST_1, 0.463),
    _Axis((0.0, 0.0, -0.10375), (pi / 2, 0.0, pi), (65.0, 295.0), 48.0, 20.0, _WRIST_2, 0.463),
    _Axis((0.0, 0.10375, 0.0), (-pi / 2, 0.0, pi), _FREE, 48.0, 20.0, _HAND, 0.99),
)  # fmt: skip
_SIX = (
    _BOTTOM,
    _Axis((0.0, 0.0016, -0.11875), (-pi / 2, 0.0, pi), _UPPER, 36.0, 80.0, _ARM, 0.99),
    _Axis((0.0, -0.41, 0.0), (0.0, pi, 0.0), (19.0, 341.0), 36.0, 40.0, _FOREARM, 0.676),
    _Axis((0.0, 0.2073, -0.0114), (-pi / 2, 0.0, pi), _FREE, 48.0, 20.0, _WRIST_1, 0.463),
    _Axis((0.0, 0.0, -0.10375), (pi / 2, 0.0, pi), (30.0, 330.0), 48.0, 20.0, _WRIST_2, 0.463),
    _Axis((0.0, 0.10375, 0.0), (-pi / 2, 0.0, pi), _FREE, 48.0, 20.0, _HAND, 0.78),
)
# Frame of the tool: z out of the hand, x to the side that the blade pushes to.
_END_EFFECTOR: tuple[Vec3, Vec3] = ((0.0, 0.0, -0.16), (pi, 0.0, pi / 2))


def kinova_j2s7s300() -> RobotDescription:
    """Return the arm with seven joints and the bluction tool, rooted at `base`."""
    return _arm("kinova_j2s7s300", _SEVEN)


def kinova_j2s6s200() -> RobotDescription:
    """Return the arm with six joints and the bluction tool, rooted at `base`."""
    return _arm("kinova_j2s6s200", _SIX)


def kinova_joint_names(joints: int) -> tuple[str, ...]:
    """Return the names of an arm's joints in chain order."""
    return tuple(f"joint_{number}" for number in range(1, joints + 1))


def _arm(name: str, axes: tuple[_Axis, ...]) -> RobotDescription:
    links = [Link("base", 0.468, (_capsule(_BASE),), _BLACK)]
    joints: list[Joint] = []
    parents = pairwise(["base", *(f"link_{number}" for number in range(1, len(axes) + 1))])
    for axis, joint, (parent, child) in zip(
        axes, kinova_joint_names(len(axes)), parents, strict=True
    ):
        colour = _GREY if len(links) % 2 else _BLACK
        links.append(Link(child, axis.mass_kg, (_capsule(axis.fit),), colour))
        joints.append(
            Joint(joint, "revolute", parent, child, axis.xyz_m, axis.rpy_rad, limits=_limits(axis))
        )
    return RobotDescription(
        name, (*links, *_tool_links()), (*joints, *_tool_joints(links[-1].name))
    )


def _capsule(fit: _Fit) -> Capsule:
    start, end, radius = fit
    return Capsule(start, end, radius + _CAPSULE_ALLOWANCE_M)


def _limits(axis: _Axis) -> Limits:
    lower, upper = (radians(value) for value in axis.range_deg)
    return Limits(lower, upper, radians(axis.speed_deg_s), axis.effort_nm)


def _tool_links() -> list[Link]:
    half_thickness, half_height = 0.5 * BLADE_THICKNESS_M, 0.5 * BLADE_HEIGHT_M
    mount = Box((-0.03, -0.03, 0.0), (0.03, 0.03, 0.03))
    plate = Box(
        (-half_thickness, -half_height, 0.03), (half_thickness, half_height, BLADE_LENGTH_M)
    )
    # A capsule ends in half a ball; the cup's lip is where that ball ends.
    lip_m = BLADE_LENGTH_M + CUP_AHEAD_M - CUP_RADIUS_M
    cups = tuple(Capsule((0.0, y, lip_m - 0.03), (0.0, y, lip_m), CUP_RADIUS_M) for y in CUPS_M)
    camera = Box((-0.0125, -0.045, -0.0125), (0.0125, 0.045, 0.0125))
    return [
        Link("end_effector", 0.001),
        Link("bluction", 0.20, (mount, plate), _ORANGE),
        Link("cup", 0.02, cups, _RUBBER),
        Link("camera_body", 0.07, (camera,), _GREY),
        *(Link(frame, 0.001) for frame in (SUCTION_FRAME, BLADE_FRAME, CAMERA_FRAME)),
    ]


def _tool_joints(last_link: str) -> list[Joint]:
    tip: Vec3 = (0.0, 0.0, BLADE_LENGTH_M + CUP_AHEAD_M)
    above, ahead = (0.0, CAMERA_M[1], 0.0), (0.0, 0.0, CAMERA_M[2])
    return [
        Joint("end_effector_mount", "fixed", last_link, "end_effector", *_END_EFFECTOR),
        Joint("bluction_mount", "fixed", "end_effector", "bluction"),
        Joint("cup_mount", "fixed", "bluction", "cup"),
        Joint("suction_mount", "fixed", "bluction", SUCTION_FRAME, tip),
        Joint("blade_mount", "fixed", "bluction", BLADE_FRAME, (0.0, 0.0, BLADE_LENGTH_M)),
        Joint("camera_mount", "fixed", "bluction", "camera_body", above),
        # A camera's frame: z into the scene, x to the right, y down.
        Joint("tool_camera_mount", "fixed", "camera_body", CAMERA_FRAME, ahead),
    ]
