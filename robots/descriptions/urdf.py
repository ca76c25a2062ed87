"""Writes a robot description as URDF that Pinocchio, PyBullet and viewers all read."""

import math
from collections.abc import Iterable
from xml.etree import ElementTree as ET

from robots.descriptions.model import Box, Capsule, Joint, Link, RobotDescription, Shape, Vec3

# Links are taken for solid balls of this radius: small, positive definite, good enough for
# position-controlled arms.
_INERTIA_RADIUS_M = 0.05


def to_urdf(robot: RobotDescription) -> str:
    """Return the description as URDF text, ending with a newline.

    Version 1.2 of the format is stated because Pinocchio's parser drops capsules otherwise.
    """
    root = ET.Element("robot", name=robot.name, version="1.2")
    root.extend(_link(link) for link in robot.links)
    root.extend(_joint(joint) for joint in robot.joints)
    ET.indent(root)
    note = "<!-- Written by `python -m robots.descriptions`; edit the tables there. -->"
    return f'<?xml version="1.0"?>\n{note}\n{ET.tostring(root, encoding="unicode")}\n'


def _numbers(values: Iterable[float]) -> str:
    return " ".join(f"{value:.9g}" for value in values)


def _origin(xyz_m: Vec3, rpy_rad: Vec3) -> ET.Element:
    return ET.Element("origin", xyz=_numbers(xyz_m), rpy=_numbers(rpy_rad))


def _link(link: Link) -> ET.Element:
    element = ET.Element("link", name=link.name)
    element.append(_inertial(link.mass_kg))
    for number, shape in enumerate(link.shapes):
        for purpose in ("visual", "collision"):
            body = ET.SubElement(element, purpose, name=f"{link.name}_{number}")
            body.extend(_shape(shape))
            if purpose == "visual":
                material = ET.SubElement(body, "material", name=f"{link.name}_material")
                ET.SubElement(material, "color", rgba=_numbers(link.colour))
    return element


def _inertial(mass_kg: float) -> ET.Element:
    element = ET.Element("inertial")
    ET.SubElement(element, "mass", value=_numbers([mass_kg]))
    moment = _numbers([0.4 * mass_kg * _INERTIA_RADIUS_M**2])
    ET.SubElement(element, "inertia", ixx=moment, iyy=moment, izz=moment, ixy="0", ixz="0", iyz="0")
    return element


def _shape(shape: Shape) -> list[ET.Element]:
    geometry = ET.Element("geometry")
    if isinstance(shape, Box):
        size = [high - low for low, high in zip(shape.low_m, shape.high_m, strict=True)]
        ET.SubElement(geometry, "box", size=_numbers(size))
        return [_origin(_middle(shape.low_m, shape.high_m), (0.0, 0.0, 0.0)), geometry]
    length = math.dist(shape.start_m, shape.end_m)
    ET.SubElement(geometry, "capsule", radius=_numbers([shape.radius_m]), length=_numbers([length]))
    return [_origin(_middle(shape.start_m, shape.end_m), _rpy_of_axis(shape)), geometry]


def _middle(a: Vec3, b: Vec3) -> Vec3:
    return ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2)


def _rpy_of_axis(capsule: Capsule) -> Vec3:
    """Return the turn that takes z to the capsule's axis: pitch about y, then yaw about z."""
    x, y, z = (end - start for start, end in zip(capsule.start_m, capsule.end_m, strict=True))
    return (0.0, math.atan2(math.hypot(x, y), z), math.atan2(y, x))


def _joint(joint: Joint) -> ET.Element:
    element = ET.Element("joint", name=joint.name, type=joint.kind)
    element.append(_origin(joint.xyz_m, joint.rpy_rad))
    ET.SubElement(element, "parent", link=joint.parent)
    ET.SubElement(element, "child", link=joint.child)
    if joint.limits is not None:
        ET.SubElement(element, "axis", xyz=_numbers(joint.axis))
        ET.SubElement(
            element,
            "limit",
            lower=_numbers([joint.limits.lower]),
            upper=_numbers([joint.limits.upper]),
            velocity=_numbers([joint.limits.velocity]),
            effort=_numbers([joint.limits.effort]),
        )
    return element
