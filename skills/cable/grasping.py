"""From image points on a cable to goals for a gripper that straddles it."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import islice

import numpy as np

from perception.cable.types import Points
from perception.camera import CameraFrame
from robots.interfaces import ARMS, Arm, DualArm, Floats, TcpGoal
from skills.cable.heights import axis_height_m
from skills.motion.goals import above

# Finger tips end 6 mm beyond the tool centre point: so high above the axis of the cable they reach
# past it, stay 2 mm above the cloth, and above a strand that it lies on.
ABOVE_AXIS_M = 0.0047
# Cable that seems higher hangs over something, or is an error of the depth.
HIGHEST_AXIS_M = 0.04
CLEARANCE_M = 0.06
# Held cable is carried at this height.
LIFT_M = 0.03
# So many places that an arm reaches are tried for a way to go on from there.
MOST_HOLDS = 6


def grasp_goal(frame: CameraFrame, point_px: Points, direction: Points) -> TcpGoal:
    """Return the goal that puts the fingers on both sides of the cable.

    Args:
        frame: Frame that the point was seen in.
        point_px: Point on the cable's centre line, shape (2,).
        direction: Tangent of the cable in the image, shape (2,).

    Returns:
        A goal at the height where the cable lies by the depth image, whose opening direction is
        square to the cable.
    """
    axis_m = min(axis_height_m(frame, point_px), HIGHEST_AXIS_M)
    position_m = frame.camera.on_plane(point_px, axis_m)[0] + np.array([0.0, 0.0, ABOVE_AXIS_M])
    # Image y runs against world y; the opening direction is the tangent turned by 90 degrees.
    yaw_rad = float(np.arctan2(direction[0], direction[1]))
    return TcpGoal(position_m, yaw_rad)


def tangent_at(points_px: Points, index: int, reach: int = 2) -> Points:
    """Return the unit tangent of a path at a point, over `reach` points to either side."""
    before = points_px[max(0, index - reach)]
    after = points_px[min(len(points_px) - 1, index + reach)]
    chord = after - before
    tangent: Points = chord / max(float(np.linalg.norm(chord)), 1e-9)
    return tangent


def nearest_arms(position_m: Points) -> tuple[Arm, Arm]:
    """Return both arms, the one on the point's side first (the left arm stands at -x)."""
    return ARMS if position_m[0] < 0.0 else (ARMS[1], ARMS[0])


@dataclass(frozen=True, slots=True, eq=False)
class Carry:
    """One hand that takes the cable along.

    Attributes:
        arm: Whose.
        goal: Where it takes hold.
        way_m: Level way that it goes with it, shape (3,).
    """

    arm: Arm
    goal: TcpGoal
    way_m: Floats

    @property
    def onward_m(self) -> tuple[Floats, ...]:
        """Straight motions after it has come down: lift, go, lay down, rise."""
        return carried(self.way_m)


def carried(way_m: Floats) -> tuple[Floats, ...]:
    """Return the straight motions of a hand that lifts, carries, lays down and rises."""
    lift_m, rise_m = np.array([0.0, 0.0, LIFT_M]), np.array([0.0, 0.0, CLEARANCE_M])
    return lift_m, way_m, -lift_m, rise_m


def first_carry(
    arms: DualArm, goals: Iterable[TcpGoal], ways_m: Callable[[TcpGoal], Iterable[Floats]]
) -> Carry | None:
    """Return the first goal and way that an arm can make from end to end.

    Args:
        arms: The arms.
        goals: Where the cable may be taken, the best first.
        ways_m: Level ways to go from a goal, the best first.
    """
    up_m = np.array([0.0, 0.0, CLEARANCE_M])
    within = (
        (arm, goal)
        for goal in goals
        for arm in nearest_arms(goal.position_m)
        if arms.reachable(arm, above(goal, CLEARANCE_M, up_m))
    )
    for arm, goal in islice(within, MOST_HOLDS):
        for way_m in ways_m(goal):
            if arms.reachable(arm, above(goal, CLEARANCE_M, *carried(way_m))):
                return Carry(arm, goal, way_m)
    return None
