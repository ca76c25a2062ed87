"""The ABB YuMi (IRB 14000) with servo grippers: its dimensions, limits and enclosing shapes.

Kinematic facts are those published in ABB's data sheet and in the public URDFs of KTH and
Orebro University (BSD-2-Clause); shapes are capsules and boxes of our own that enclose the
links. Joints are counted along the chain, 1 to 7; ABB numbers the same axes 1, 2, 7, 3, 4, 5, 6.
The two arms are not mirror images: joint 1 is mounted differently in the fourth digit.
"""

from itertools import pairwise
from math import pi, radians

from robots.descriptions.model import Box, Capsule, Joint, Limits, Link, RobotDescription, Vec3
from robots.interfaces import ARMS, Arm

TCP_FROM_GRIPPER_BASE_M = 0.130
# The tool gets 0.703 m away from joint 2 at most (over random configurations), and joint 2 is
# 0.104 m from joint 1.
REACH_M = 0.807
# How far the hand gets from each joint's axis, rounded up; the last turns only the hand.
LEVERS_M = (0.74, 0.71, 0.50, 0.45, 0.21, 0.18, 0.04)
FINGER_STROKE_M = 0.025  # of each finger
# How far apart the fingers of an open hand are: a grasp may be 1 cm off, and strands that lie
# beside the one that is wanted stay outside.
OPEN_OPENING_M = 0.03
FINGER_SPEED_M_S = 0.025
CAGE_OPENING_M = 0.011  # a ring that the cable slides through and its plug does not
_CAPSULE_ALLOWANCE_M = 0.001  # the fits let mesh vertices stick out by up to 0.61 mm

_SHOULDER: dict[Arm, tuple[Vec3, Vec3]] = {
    "left": ((0.05355, 0.0725, 0.41492), (0.9781, -0.5716, 2.3180)),
    "right": ((0.05355, -0.0725, 0.41492), (-0.9795, -0.5682, -2.3155)),
}

# Origins of joints 2 to 7 in their parent links: xyz [m], rpy [rad].
_ORIGINS: tuple[tuple[Vec3, Vec3], ...] = (
    ((0.03, 0.0, 0.1), (pi / 2, 0.0, 0.0)),
    ((-0.03, 0.17283, 0.0), (-pi / 2, 0.0, 0.0)),
    ((-0.04188, 0.0, 0.07873), (pi / 2, -pi / 2, 0.0)),
    ((0.0405, 0.16461, 0.0), (-pi / 2, 0.0, 0.0)),
    ((-0.027, 0.0, 0.10039), (pi / 2, 0.0, 0.0)),
    ((0.027, 0.029, 0.0), (-pi / 2, 0.0, 0.0)),
)

# Lower and upper position [deg], speed [deg/s], effort [Nm] (not published; a rough guess).
_LIMITS_DEG: tuple[tuple[float, float, float, float], ...] = (
    (-168.5, 168.5, 180.0, 60.0),
    (-143.5, 43.5, 180.0, 60.0),
    (-168.5, 168.5, 180.0, 40.0),
    (-123.5, 80.0, 180.0, 40.0),
    (-290.0, 290.0, 400.0, 20.0),
    (-88.0, 138.0, 400.0, 20.0),
    (-229.0, 229.0, 400.0, 20.0),
)

# One capsule a link: segment ends and radius [m].
_CAPSULES: tuple[tuple[Vec3, Vec3, float], ...] = (
    ((-0.0002, 0.0005, 0.0086), (0.0264, -0.0364, 0.0937), 0.0619),
    ((-0.0302, 0.1315, 0.0002), (-0.001, 0.0012, -0.0295), 0.0627),
    ((-0.0412, -0.034, 0.0786), (-0.0003, -0.0006, 0.0271), 0.0525),
    ((0.0411, 0.126, 0.0021), (0.0023, -0.0005, -0.0294), 0.0561),
    ((-0.0176, -0.0472, 0.0942), (0.001, -0.0026, 0.0127), 0.045),
    ((0.0225, -0.0092, -0.003), (0.0029, -0.0152, -0.0193), 0.057),
    ((0.0058, -0.0058, 0.0021), (-0.0061, 0.0061, 0.0011), 0.0273),
)
_GRIPPER_CAPSULE: tuple[Vec3, Vec3, float] = ((0.0, 0.0055, 0.0626), (0.0, 0.0025, 0.022), 0.0421)
_LINK_MASSES_KG = (2.0, 2.0, 1.5, 1.5, 1.0, 0.7, 0.3)  # not published; about 9 kg an arm

# Base, feet, column, head: corners in the body frame [m].
_BODY = (
    Box((-0.36, -0.20, -0.10), (0.001, 0.20, 0.10)),
    Box((0.0, 0.05, -0.05), (0.135, 0.20, 0.06)),
    Box((0.0, -0.20, -0.05), (0.135, -0.05, 0.06)),
    Box((-0.36, -0.117, 0.10), (-0.12, 0.117, 0.30)),
    Box((-0.36, -0.13, 0.29), (0.088, 0.13, 0.471)),
)

# A finger's inner face is its plane x = 0 and the hand's middle plane is at y = 0.0065. The
# lower half is slimmed as cable fingers are, so that it passes between neighbouring strands
# and a hand tilted about the opening axis still comes down to the table.
_FINGER = (
    Box((-0.011, -0.0045, 0.0), (0.0, 0.0167, 0.030)),
    Box((-0.005, 0.0025, 0.030), (0.0, 0.0105, 0.0522)),
)
_WHITE = (0.86, 0.86, 0.84, 1.0)
_GREY = (0.45, 0.46, 0.48, 1.0)
_DARK = (0.16, 0.16, 0.17, 1.0)


def arm_joint_names(arm: Arm) -> tuple[str, ...]:
    """Return the names of an arm's seven joints in chain order."""
    return tuple(f"{arm}_joint_{number}" for number in range(1, 8))


def finger_joint_names(arm: Arm) -> tuple[str, str]:
    """Return the names of the two finger joints; both always have the same position."""
    return f"{arm}_finger_a_joint", f"{arm}_finger_b_joint"


def tcp_frame(arm: Arm) -> str:
    """Return the name of an arm's tool frame: z out of the hand, x along the opening."""
    return f"{arm}_tcp"


def yumi() -> RobotDescription:
    """Return the robot, rooted at `body`, whose frame lies 0.10 m above the feet's floor."""
    links: list[Link] = [Link("body", 20.0, _BODY)]
    joints: list[Joint] = []
    for arm in ARMS:
        links += [*_arm_links(arm), *_hand_links(arm)]
        joints += [*_arm_joints(arm), *_hand_joints(arm)]
    return RobotDescription("yumi", tuple(links), tuple(joints))


def _capsule(fit: tuple[Vec3, Vec3, float]) -> Capsule:
    start, end, radius = fit
    return Capsule(start, end, radius + _CAPSULE_ALLOWANCE_M)


def _arm_links(arm: Arm) -> list[Link]:
    return [
        Link(f"{arm}_link_{number}", mass, (_capsule(fit),), _WHITE if number % 2 else _GREY)
        for number, (fit, mass) in enumerate(zip(_CAPSULES, _LINK_MASSES_KG, strict=True), 1)
    ]


def _arm_joints(arm: Arm) -> list[Joint]:
    parents = pairwise(["body", *(f"{arm}_link_{number}" for number in range(1, 8))])
    origins = (_SHOULDER[arm], *_ORIGINS)
    return [
        Joint(name, "revolute", parent, child, xyz, rpy, limits=_revolute_limits(limits))
        for name, (parent, child), (xyz, rpy), limits in zip(
            arm_joint_names(arm), parents, origins, _LIMITS_DEG, strict=True
        )
    ]


def _revolute_limits(row: tuple[float, float, float, float]) -> Limits:
    lower_deg, upper_deg, speed_deg_s, effort = row
    return Limits(radians(lower_deg), radians(upper_deg), radians(speed_deg_s), effort)


def _hand_links(arm: Arm) -> list[Link]:
    return [
        Link(f"{arm}_gripper_base", 0.18, (_capsule(_GRIPPER_CAPSULE),), _DARK),
        Link(f"{arm}_finger_a", 0.02, _FINGER, _GREY),
        Link(f"{arm}_finger_b", 0.02, _FINGER, _GREY),
        Link(f"{arm}_tcp", 0.001),
    ]


def _hand_joints(arm: Arm) -> list[Joint]:
    base = f"{arm}_gripper_base"
    stroke = Limits(0.0, FINGER_STROKE_M, FINGER_SPEED_M_S, 20.0)
    finger_a, finger_b = finger_joint_names(arm)
    outwards: Vec3 = (-1.0, 0.0, 0.0)
    tcp: Vec3 = (0.0, 0.0, TCP_FROM_GRIPPER_BASE_M)
    turned: Vec3 = (0.0, 0.0, pi)
    return [
        Joint(f"{arm}_flange", "fixed", f"{arm}_link_7", base, (0.0, 0.0, 0.007), turned),
        Joint(finger_a, "prismatic", base, f"{arm}_finger_a", (0.0, -0.0065, 0.0837),
              axis=outwards, limits=stroke),
        Joint(finger_b, "prismatic", base, f"{arm}_finger_b", (0.0, 0.0065, 0.0837), turned,
              axis=outwards, limits=stroke),
        Joint(f"{arm}_tcp_mount", "fixed", base, f"{arm}_tcp", tcp),
    ]  # fmt: skip
