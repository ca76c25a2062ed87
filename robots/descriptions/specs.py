"""By which names the arms of a robot are found in its URDF, and which of its bodies overlap."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from executive.core.errors import InputError
from executive.core.registry import closest
from robots.descriptions import urdf_path
from robots.descriptions.kinova import SUCTION_FRAME, kinova_joint_names
from robots.descriptions.yumi import (
    LEVERS_M,
    REACH_M,
    arm_joint_names,
    finger_joint_names,
    tcp_frame,
)
from robots.interfaces import ARMS

# The one arm of a robot that has no more.
ARM = "arm"


@dataclass(frozen=True, slots=True)
class ArmSpec:
    """What one arm of a robot is called in a URDF.

    Attributes:
        joints: In chain order.
        tcp: Frame of the tool centre point; z out of the tool.
        fingers: Joints that each make half of a gripper's opening.
        tool_links: Links besides fingers that come as close to things as fingers do.
        levers_m: How far the farthest part that a joint moves is from its axis, each [m];
            measured on the model when None.
        reach_m: The tool is never farther than this from the first joint's frame [m];
            bounded by the lengths of the links when None.
    """

    joints: tuple[str, ...]
    tcp: str
    fingers: tuple[str, ...] = ()
    tool_links: tuple[str, ...] = ()
    levers_m: tuple[float, ...] | None = None
    reach_m: float | None = None


@dataclass(frozen=True, slots=True)
class RobotSpec:
    """A robot as planning takes it.

    Attributes:
        name: For messages.
        urdf: Its description.
        arms: In the order of configurations.
        overlaps: Pairs of links, or of single shapes of them (`LINK_NUMBER`), that may overlap.
    """

    name: str
    urdf: Path
    arms: Mapping[str, ArmSpec]
    overlaps: tuple[tuple[str, str], ...] = ()


def yumi_spec() -> RobotSpec:
    """Return the YuMi, left arm first.

    Besides neighbours, some bodies overlap by construction of their enclosing shapes: the
    body's head box (its fifth shape) encloses what the shoulders turn in.
    """
    arms: dict[str, ArmSpec] = {
        arm: ArmSpec(
            arm_joint_names(arm),
            tcp_frame(arm),
            finger_joint_names(arm),
            levers_m=LEVERS_M,
            reach_m=REACH_M,
        )
        for arm in ARMS
    }
    overlaps = tuple(
        pair
        for arm in ARMS
        for pair in (
            ("body_4", f"{arm}_link_2_0"),
            (f"{arm}_link_5_0", f"{arm}_link_7_0"),
            (f"{arm}_link_5_0", f"{arm}_gripper_base_0"),
        )
    )
    return RobotSpec("yumi", urdf_path("yumi"), arms, overlaps)


def kinova_spec(joints: int, tcp: str = SUCTION_FRAME) -> RobotSpec:
    """Return the Kinova Gen2 of seven or six joints with the bluction tool; its arm is `arm`.

    Args:
        joints: 7 or 6.
        tcp: Frame that goals are about: the suction cup's, the blade's or the tool camera's.
    """
    name = {7: "kinova_j2s7s300", 6: "kinova_j2s6s200"}[joints]
    arm = ArmSpec(kinova_joint_names(joints), tcp, tool_links=("bluction", "cup"))
    return RobotSpec(name, urdf_path(name), {ARM: arm})


SPECS: dict[str, Callable[[], RobotSpec]] = {
    "kinova_j2s6s200": lambda: kinova_spec(6),
    "kinova_j2s7s300": lambda: kinova_spec(7),
    "yumi": yumi_spec,
}


def robot_spec(name: str) -> RobotSpec:
    """Return a robot that ships with the package.

    Raises:
        InputError: There is none of that name.
    """
    if name not in SPECS:
        raise InputError(f"unknown robot {name!r}; {closest(name, [*SPECS])}")
    return SPECS[name]()
