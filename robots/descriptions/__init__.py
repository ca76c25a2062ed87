"""Robots as data: tables of dimensions, and the URDF files that are written from them."""

from collections.abc import Callable
from pathlib import Path

from robots.descriptions.kinova import kinova_j2s6s200, kinova_j2s7s300
from robots.descriptions.model import RobotDescription
from robots.descriptions.yumi import yumi

DESCRIPTIONS: dict[str, Callable[[], RobotDescription]] = {
    "kinova_j2s6s200": kinova_j2s6s200,
    "kinova_j2s7s300": kinova_j2s7s300,
    "yumi": yumi,
}


def urdf_path(name: str) -> Path:
    """Return the packaged URDF file of a robot, e.g. `yumi`."""
    return Path(__file__).with_name(f"{name}.urdf")
