"""What stands still, and how what moves is drawn: a cell as a list of Meshcat's commands."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from meshcat.commands import Delete, SetObject, SetProperty, SetTransform
from meshcat.geometry import (
    Box,
    LineBasicMaterial,
    LineSegments,
    MeshBasicMaterial,
    MeshPhongMaterial,
    PointsGeometry,
)
from meshcat.path import Path
from scipy.spatial.transform import Rotation

from robots.descriptions.model import Box as DescribedBox
from robots.descriptions.model import Link, RobotDescription, Shape, Vec3
from robots.interfaces import Floats
from robots.placement import Placement, PlanningScene, StaticBox
from robots.viewer.frame import CameraCone, SceneFrame, ShownBox, thinned
from robots.viewer.shapes import Tube, drawn

CABLE_POINTS = 120
TRACE_POINTS = 120
TRACE_RADIUS_M = 0.006  # wider than the cable: a halo where the trace agrees with it

# Of several cables each has a shade of its own.
_CABLES = tuple(
    MeshPhongMaterial(color=colour, shininess=40)
    for colour in (0xF4F4F0, 0x9CC9F2, 0xF2C49C, 0xB7E0A8)
)
_TRACE = MeshBasicMaterial(color=0xFF9A2E, opacity=0.8)
_WOOD = MeshPhongMaterial(color=0xB9A68A)
_CLOTH = MeshPhongMaterial(color=0x17181B, shininess=2)
_METAL = MeshPhongMaterial(color=0x8A8F98)
_GLASS = MeshPhongMaterial(color=0xB9A68A, opacity=0.3, transparent=True)
_LENS = MeshPhongMaterial(color=0x2B2F36)
_SIGHT = LineBasicMaterial(color=0x5B8DEF)

_FLOOR_M = -0.75
_CLOTH_M = 0.002
_CAMERA_BOX_M = (0.10, 0.06, 0.06)
_FIELD_OF_VIEW_DEG = 42.0
# Meshcat's own lights, dimmed so that a white robot keeps its shape.
_LIGHTS = {
    "AmbientLight": 0.68,
    "FillLight": 0.2,
    "PointLightNegativeX": 0.42,
    "PointLightPositiveX": 0.25,
}


@dataclass(frozen=True, slots=True)
class Eye:
    """Where one looks from at first, and where to, in the world [m].

    Attributes:
        from_m: Of the eye.
        to_m: What is in the middle of the picture, and what the eye turns about.
    """

    from_m: Vec3
    to_m: Vec3 = (0.0, 0.0, 0.0)


# From beyond a table, over its right corner.
TABLE_EYE = Eye((0.85, 1.50, 1.05))


@dataclass(frozen=True, slots=True, eq=False)
class Stage:
    """A cell before anything moves.

    Attributes:
        robot: Its links are drawn from its shapes.
        scene: Where the robot stands, and the boxes around it; a box named `table` gets a
            cloth and legs.
        eye: From where it is looked at.
        glass: Names of boxes that are drawn so that one can look through them.
    """

    robot: RobotDescription
    scene: PlanningScene
    eye: Eye = TABLE_EYE
    glass: frozenset[str] = frozenset()

    def commands(self) -> Iterator[Any]:
        """Yield the commands that build the scene."""
        yield from _surroundings(self.eye)
        for box in self.scene.boxes:
            material = _GLASS if box.name in self.glass else _METAL
            path = f"cell/{box.name}"
            yield from _table(box) if box.name == "table" else _box(path, box, material)
        yield from self._robot()

    def _robot(self) -> Iterator[Any]:
        for link in self.robot.links:
            red, green, blue, alpha = link.colour
            colour = (round(255 * red) << 16) + (round(255 * green) << 8) + round(255 * blue)
            material = MeshPhongMaterial(color=colour, opacity=alpha)
            for number, shape in enumerate(link.shapes):
                geometry, T_link_shape = drawn(shape)
                path = _path(f"robot/{link.name}/{number}")
                yield SetObject(geometry, material, path)
                yield SetTransform(T_link_shape, path)
        placement = self.scene.placement
        root_pose = np.concatenate(
            [placement.position_m, Rotation.from_euler("z", placement.yaw_rad).as_quat()]
        )
        root = self.robot.links[0]
        yield move_link(root.name, root_pose)
        yield from _pedestal(root, placement)


def move_link(name: str, pose: Floats) -> SetTransform:
    """Return the command that puts a link to a pose: position [m], quaternion xyzw."""
    T_world_link = np.eye(4)
    T_world_link[:3, :3] = Rotation.from_quat(pose[3:]).as_matrix()
    T_world_link[:3, 3] = pose[:3]
    return SetTransform(T_world_link, _path(f"robot/{name}"))


def draw_box(name: str, box: ShownBox) -> SetObject:
    """Return the command that draws a box that moves; `move_link` puts it to its place."""
    red, green, blue = box.colour
    material = MeshPhongMaterial(color=(red << 16) + (green << 8) + blue, shininess=8)
    return SetObject(Box(list(box.size_m)), material, _path(f"robot/{name}"))


def draw_cable(cable_m: Floats, radius_m: float, number: int = 0) -> SetObject:
    """Return the command that draws a cable along its centre line, shape (N, 3)."""
    tube = Tube(thinned(cable_m, CABLE_POINTS), radius_m)
    material = _CABLES[number % len(_CABLES)]
    return SetObject(tube, material, _path(f"cable_{number}" if number else "cable"))


def draw_trace(frame: SceneFrame) -> SetObject | Delete:
    """Return the command that lays the trace of a frame on the table, or takes it away."""
    if frame.trace_m is None:
        return Delete(_path("trace"))
    tube = Tube(thinned(frame.trace_m, TRACE_POINTS), TRACE_RADIUS_M)
    return SetObject(tube, _TRACE, _path("trace"))


def _path(text: str) -> Path:
    return Path(tuple(text.split("/")))


def _surroundings(eye_at: Eye) -> Iterator[Any]:
    """Set the background, the lights, the floor and the eye."""
    yield SetProperty("top_color", [0.93, 0.95, 0.97], _path("Background"))
    yield SetProperty("bottom_color", [0.70, 0.74, 0.79], _path("Background"))
    yield SetProperty("visible", False, _path("Axes"))
    yield SetTransform(_shift((0.0, 0.0, _FLOOR_M)), _path("Grid"))
    for light, intensity in _LIGHTS.items():
        yield SetProperty("intensity", intensity, _path(f"Lights/{light}/<object>"))
    eye = _path("Cameras/default/rotated/<object>")
    yield SetTransform(_shift(eye_at.to_m), _path("Cameras/default"))
    x, y, z = np.subtract(eye_at.from_m, eye_at.to_m).tolist()
    yield SetProperty("position", [x, z, -y], eye)  # the eye's own frame has y up
    yield SetProperty("fov", _FIELD_OF_VIEW_DEG, eye)


def _table(top: StaticBox) -> Iterator[Any]:
    yield from _box("cell/table", top, _WOOD)
    (x, y, z), (width, depth, height) = top.centre_m, top.size_m
    cloth = StaticBox("cloth", (x, y, z + (height - _CLOTH_M) / 2 + 1e-4), (width, depth, _CLOTH_M))
    yield from _box("cell/cloth", cloth, _CLOTH)
    leg_m = z - height / 2 - _FLOOR_M
    for number, (side, end) in enumerate(((-1, -1), (-1, 1), (1, -1), (1, 1))):
        middle = (x + side * (width / 2 - 0.04), y + end * (depth / 2 - 0.04), _FLOOR_M + leg_m / 2)
        yield from _box(f"cell/leg_{number}", StaticBox("leg", middle, (0.05, 0.05, leg_m)), _METAL)


def _pedestal(root: Link, placement: Placement) -> Iterator[Any]:
    """Put a block under the first shape of the robot's root, down to the floor."""
    low_m, high_m = _bounds(root.shapes[0])
    under_m = placement.position_m[2] + low_m[2] - _FLOOR_M
    middle_m = (low_m + high_m) / 2
    T_world_block = np.eye(4)
    turn = Rotation.from_euler("z", placement.yaw_rad)
    T_world_block[:3, :3] = turn.as_matrix()
    T_world_block[:3, 3] = placement.position_m + turn.apply([middle_m[0], middle_m[1], 0.0])
    T_world_block[2, 3] = _FLOOR_M + under_m / 2
    path = _path("cell/pedestal")
    width, depth = (high_m - low_m)[:2]
    yield SetObject(Box([width, depth, under_m]), _METAL, path)
    yield SetTransform(T_world_block, path)


def _bounds(shape: Shape) -> tuple[Floats, Floats]:
    """Return the lowest and the highest corner around a shape in its link [m]."""
    if isinstance(shape, DescribedBox):
        return np.asarray(shape.low_m), np.asarray(shape.high_m)
    ends_m = np.array([shape.start_m, shape.end_m])
    return ends_m.min(axis=0) - shape.radius_m, ends_m.max(axis=0) + shape.radius_m


def draw_camera(camera: CameraCone) -> Iterator[Any]:
    """Yield the commands that draw the camera and what it sees."""
    x, y, z = (float(value) for value in camera.position_m)
    yield from _box("camera/body", StaticBox("camera", (x, y, z + 0.03), _CAMERA_BOX_M), _LENS)
    edges = [(camera.position_m, corner) for corner in camera.corners_m]
    edges += list(zip(camera.corners_m, np.roll(camera.corners_m, -1, axis=0), strict=True))
    ends_m = np.asarray(edges, dtype=np.float32).reshape(-1, 3)
    yield SetObject(LineSegments(PointsGeometry(ends_m.T), _SIGHT), None, _path("camera/sight"))


def _box(path: str, box: StaticBox, material: MeshPhongMaterial) -> Iterator[Any]:
    yield SetObject(Box(list(box.size_m)), material, _path(path))
    yield SetTransform(_shift(box.centre_m), _path(path))


def _shift(offset_m: Vec3) -> Floats:
    T = np.eye(4)
    T[:3, 3] = offset_m
    return T
