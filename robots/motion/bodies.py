"""What takes part in collision checks besides the links: boxes of the scene and in hands."""

import coal
import numpy as np
import pinocchio as pin

from executive.core.errors import InputError
from executive.core.registry import closest
from robots.motion.model import RobotModel
from robots.placement import AttachedBox, PlanningScene, StaticBox


def named_boxes(robot: RobotModel, scene: PlanningScene) -> dict[str, StaticBox | AttachedBox]:
    """Return all boxes of a scene by name.

    Raises:
        InputError: A name is not unique, or an arm that carries something is not known.
    """
    boxes: dict[str, StaticBox | AttachedBox] = {}
    everything: list[StaticBox | AttachedBox] = [*scene.boxes, *scene.attached]
    for box in everything:
        if box.name in boxes or robot.model.existFrame(box.name):
            raise InputError(
                f"planning scene: two bodies are called {box.name!r}; expected one of each name"
            )
        boxes[box.name] = box
    for carried in scene.attached:
        if carried.arm not in robot.arms:
            raise InputError(
                f"planning scene: {carried.name}: no arm {carried.arm!r}; "
                f"{closest(carried.arm, [*robot.arms])}"
            )
    return boxes


def arm_of(robot: RobotModel, joint: int) -> str | None:
    """Return which arm moves what hangs on a joint; None for what no arm moves."""
    for arm, spec in robot.spec.arms.items():
        first = robot.model.getJointId(spec.joints[0])
        if joint in robot.model.subtrees[first]:
            return arm
    return None


def tool_bodies(robot: RobotModel) -> set[str]:
    """Return the links that come as close to things as fingers do."""
    model = robot.model
    tools = {link for spec in robot.spec.arms.values() for link in spec.tool_links}
    fingers = {model.getJointId(name) for spec in robot.spec.arms.values() for name in spec.fingers}
    links = [frame for frame in model.frames if frame.type == pin.FrameType.BODY]
    return tools | {str(link.name) for link in links if link.parentJoint in fingers}


def static_geometry(box: StaticBox) -> pin.GeometryObject:
    """Return a box that stands in the world."""
    return pin.GeometryObject(box.name, 0, _pose(box), coal.Box(*box.size_m))


def attached_geometry(robot: RobotModel, box: AttachedBox) -> pin.GeometryObject:
    """Return a box that moves with an arm's tool."""
    tool = robot.model.frames[robot.model.getFrameId(robot.spec.arms[box.arm].tcp)]
    placed = tool.placement * _pose(box)
    return pin.GeometryObject(box.name, tool.parentJoint, placed, coal.Box(*box.size_m))


def _pose(box: StaticBox | AttachedBox) -> pin.SE3:
    return pin.XYZQUATToSE3(np.array([*box.centre_m, *box.quat_xyzw]))
