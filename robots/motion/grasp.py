"""Which poses of a tool satisfy a goal: turns that serve as well, and leaning where that helps."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from math import cos, pi, sin

import numpy as np
import pinocchio as pin

from robots.interfaces import Floats, Goal, PoseGoal, TcpGoal

# Yaws that are tried when a goal leaves the yaw free: eight over half a turn.
_FREE_YAWS = tuple(pi * step / 8 for step in range(8))
_DOWN: Floats = np.array([0.0, 0.0, -1.0])
_AXES: Floats = np.eye(3)


@dataclass(frozen=True, slots=True, eq=False)
class ToolPose:
    """One way to satisfy a goal.

    Attributes:
        T_world_tcp: Pose of the tool.
        tilt_rad: How far it leans from the orientation asked for.
    """

    T_world_tcp: pin.SE3
    tilt_rad: float


def pointing_down(yaw_rad: float) -> Floats:
    """Return the rotation of a tool that points down and opens along a yaw, shape (3, 3)."""
    c, s = cos(yaw_rad), sin(yaw_rad)
    return np.array([[c, s, 0.0], [s, -c, 0.0], [0.0, 0.0, -1.0]])


def tool_poses(goal: Goal, shoulder_m: Floats) -> Iterator[tuple[ToolPose, ...]]:
    """Yield groups of poses that satisfy a goal, the straightest group first.

    Args:
        goal: What is asked of the tool.
        shoulder_m: Where the arm starts, in the world, shape (3,).
    """
    return _turned(goal) if isinstance(goal, PoseGoal) else _downward(goal, shoulder_m)


def _turned(goal: PoseGoal) -> Iterator[tuple[ToolPose, ...]]:
    """Yield poses in one orientation, turned about its axis, then leaning to all sides."""
    asked = pin.Quaternion(goal.quat_xyzw).normalized().toRotationMatrix()
    turns = [asked @ _about(turn, _AXES[2]) for turn in goal.turns_rad]
    yield tuple(ToolPose(pin.SE3(turn, goal.position_m), 0.0) for turn in turns)
    tilts = (0.5 * goal.max_tilt_rad, goal.max_tilt_rad) if goal.max_tilt_rad > 0.0 else ()
    for tilt in tilts:
        leans = [
            asked @ _about(sign * tilt, axis) @ asked.T for axis in _AXES[:2] for sign in (1, -1)
        ]
        yield tuple(
            ToolPose(pin.SE3(lean @ turn, goal.position_m), tilt)
            for lean in leans
            for turn in turns
        )


def _about(angle_rad: float, axis: Floats) -> Floats:
    rotation: Floats = pin.AngleAxis(angle_rad, axis).toRotationMatrix()
    return rotation


def _downward(goal: TcpGoal, shoulder_m: Floats) -> Iterator[tuple[ToolPose, ...]]:
    """Yield poses of a gripper that points down.

    Each pose comes with its twin, half a turn about the tool's axis, which is the same grasp.
    Leaning is first about the opening axis, which keeps both fingertips level, then outward,
    the fingers ahead of the wrist, and last inward, for places close to the body.
    """
    yaws = _FREE_YAWS if goal.yaw_rad is None else (goal.yaw_rad,)
    yield tuple(pose for yaw in yaws for pose in _twins(goal, pointing_down(yaw), 0.0))
    outward = _horizontal(goal.position_m - shoulder_m)
    half, full = goal.max_tilt_rad / 2, goal.max_tilt_rad
    if full <= 0.0:
        return
    for tilt in (half, full):
        yield tuple(_leaning(goal, yaws, _level_leans, tilt))
    for tilt, towards in ((half, outward), (full, outward), (full, -outward)):
        yield tuple(_leaning(goal, yaws, partial(_one_lean, towards), tilt))


def _leaning(
    goal: TcpGoal, yaws: Sequence[float], leans: Callable[[float], tuple[Floats, ...]], tilt: float
) -> Iterator[ToolPose]:
    for yaw in yaws:
        for lean in leans(yaw):
            yield from _twins(goal, _leant(pointing_down(yaw), lean, tilt), tilt)


def _level_leans(yaw_rad: float) -> tuple[Floats, ...]:
    """Return the two directions square to the opening."""
    level = np.array([-sin(yaw_rad), cos(yaw_rad), 0.0])
    return level, -level


def _twins(goal: TcpGoal, rotation: Floats, tilt_rad: float) -> Iterator[ToolPose]:
    for turn in (1.0, -1.0):
        turned = rotation * np.array([turn, turn, 1.0])
        yield ToolPose(pin.SE3(turned, goal.position_m), tilt_rad)


def _horizontal(vector: Floats) -> Floats:
    flat = np.array([vector[0], vector[1], 0.0])
    length = float(np.linalg.norm(flat))
    return flat / length if length > 1e-6 else np.array([0.0, 1.0, 0.0])


def _one_lean(towards: Floats, _yaw_rad: float) -> tuple[Floats, ...]:
    return (towards,)


def _leant(rotation: Floats, towards: Floats, tilt_rad: float) -> Floats:
    """Turn a rotation so that the tool's axis leans towards a horizontal unit vector."""
    axis = np.cross(_DOWN, towards)
    return _about(tilt_rad, axis) @ rotation
