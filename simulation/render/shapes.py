"""Turns the bodies of the table cell into shapes: robot links, the cable, its two plugs."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from robots.descriptions.model import Box, Capsule, RobotDescription, Vec3
from simulation.render.primitives import Material, Primitives, boxes, capsules, join

Floats = NDArray[np.float64]

_CABLE_ALBEDO = 0.84
_VISIBLE_SHARE = 0.85  # of the sleeve's radius; the rest is fluff
_PIECES_A_SEGMENT = 4  # the centre line is smoothed, so that bends show no corners

# Parts of the plugs in the plug's frame: low and high corner [mm], albedo, material. The body
# of a plug spans x from -10 to 10 mm.
_Part = tuple[Vec3, Vec3, float, Material]
_USB_A: tuple[_Part, ...] = (
    ((-10.0, -7.8, -4.0), (6.0, 7.8, 4.0), 0.80, Material.PLASTIC),
    ((6.0, -6.0, -2.2), (18.5, 6.0, 2.2), 0.26, Material.METAL),
    ((9.0, 1.6, 2.0), (11.0, 4.4, 2.4), 0.95, Material.PLASTIC),
    ((9.0, -4.4, 2.0), (11.0, -1.6, 2.4), 0.95, Material.PLASTIC),
)
_MICRO_USB: tuple[_Part, ...] = (
    ((-10.0, -4.8, -3.4), (10.0, 4.8, 3.4), 0.92, Material.PLASTIC),
    ((10.0, -3.4, -1.2), (15.5, 3.4, 1.2), 0.34, Material.METAL),
)
# The sleeve that relieves the strain: where it begins, and how thick it is at the body.
_RELIEF_START_M = -0.020
_RELIEF_STEPS = 6
_USB_A_RELIEF_M, _MICRO_USB_RELIEF_M = 0.0065, 0.0045


def robot_shapes(robot: RobotDescription, T_world_links: Mapping[str, Floats]) -> Primitives:
    """Return the shapes of all links at their poses (4, 4)."""
    parts = [
        _link_shape(shape, T_world_links[link.name], float(np.mean(link.colour[:3])))
        for link in robot.links
        for shape in link.shapes
    ]
    return join(parts)


def cable_shapes(nodes_m: Floats, radius_m: float, T_world_plugs: Floats) -> Primitives:
    """Return a cable with its plugs.

    Args:
        nodes_m: Centre line in the world [m], shape (N, 3).
        radius_m: Radius of the sleeve.
        T_world_plugs: Poses of the plugs at the first and the last node, shape (2, 4, 4); x
            points out of the cable's end, the origin is the middle of the body.
    """
    usb_a, micro_usb = T_world_plugs
    return join(
        [
            _sleeve(nodes_m, radius_m),
            *_plug(usb_a, _USB_A, (radius_m, _USB_A_RELIEF_M)),
            *_plug(micro_usb, _MICRO_USB, (radius_m, _MICRO_USB_RELIEF_M)),
        ]
    )


def smooth_line(nodes_m: Floats, pieces: int = _PIECES_A_SEGMENT) -> Floats:
    """Return a Catmull-Rom curve through the nodes, shape ((N - 1) * pieces + 1, 3)."""
    padded = np.vstack([2 * nodes_m[0] - nodes_m[1], nodes_m, 2 * nodes_m[-1] - nodes_m[-2]])
    p0, p1, p2, p3 = (padded[i : len(nodes_m) - 1 + i, None] for i in range(4))
    t = (np.arange(pieces) / pieces)[None, :, None]
    curve = p1 + 0.5 * t * (
        p2 - p0 + t * (2 * p0 - 5 * p1 + 4 * p2 - p3 + t * (3 * (p1 - p2) + p3 - p0))
    )
    return np.vstack([curve.reshape(-1, 3), nodes_m[-1]])


def _link_shape(shape: Box | Capsule, T_world_link: Floats, albedo: float) -> Primitives:
    if isinstance(shape, Box):
        return _box(T_world_link, shape.low_m, shape.high_m, albedo, Material.PAINT)
    ends = np.array([shape.start_m, shape.end_m]) @ T_world_link[:3, :3].T + T_world_link[:3, 3]
    return capsules(ends[:1], ends[1:], np.array([shape.radius_m]), albedo, Material.PAINT)


def _box(
    T_world_body: Floats, low_m: Vec3, high_m: Vec3, albedo: float, material: Material
) -> Primitives:
    low, high = np.array(low_m), np.array(high_m)
    T_world_box = T_world_body.copy()
    T_world_box[:3, 3] += T_world_body[:3, :3] @ (0.5 * (low + high))
    return boxes(T_world_box[None], 0.5 * (high - low)[None], albedo, material)


def _sleeve(nodes_m: Floats, radius_m: float) -> Primitives:
    line = smooth_line(nodes_m)
    arc_m = np.concatenate([[0.0], np.linalg.norm(np.diff(line, axis=0), axis=1).cumsum()])
    radii_m = np.full(len(line) - 1, _VISIBLE_SHARE * radius_m)
    sleeve = capsules(line[:-1], line[1:], radii_m, _CABLE_ALBEDO, Material.BRAID)
    return sleeve._replace(arc_m=np.column_stack([arc_m[:-1], arc_m[1:]]))


def _plug(
    T_world_plug: Floats, parts: tuple[_Part, ...], relief_radii_m: tuple[float, float]
) -> list[Primitives]:
    body = [
        _box(T_world_plug, _metres(low_mm), _metres(high_mm), albedo, material)
        for low_mm, high_mm, albedo, material in parts
    ]
    along_m = np.linspace(_RELIEF_START_M, 1e-3 * parts[0][0][0], _RELIEF_STEPS + 1)
    line = T_world_plug[:3, 3] + along_m[:, None] * T_world_plug[:3, 0]
    radii_m = np.linspace(*relief_radii_m, _RELIEF_STEPS)
    return [*body, capsules(line[:-1], line[1:], radii_m, 0.7, Material.PLASTIC)]


def _metres(corner_mm: Vec3) -> Vec3:
    x, y, z = corner_mm
    return 1e-3 * x, 1e-3 * y, 1e-3 * z
