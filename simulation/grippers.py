"""Fingers that open and close at their own speed, and what they take hold of."""

import math
from dataclasses import dataclass

from robots.descriptions.yumi import FINGER_SPEED_M_S, FINGER_STROKE_M
from robots.interfaces import Arm, Grip
from simulation.cable.rod import Rod

OPEN_M = 2.0 * FINGER_STROKE_M
CAGE_M = 0.011  # a ring that the cable slides through and its plug does not
_SLACK_M = 0.0006  # closed fingers leave this to the cable's grasp, instead of pressing on it

# The space between the fingers: how deep inside the hand, and how wide, a cable counts.
FINGER_DEPTH_M = 0.020
FINGER_WIDTH_M = 0.008


@dataclass(slots=True)
class Gripper:
    """One hand's fingers.

    Attributes:
        arm: Whose hand.
        opening_m: Distance between the fingers.
        target_m: Where they are going.
        closed_on: How many strands of cable they have between them.
    """

    arm: Arm
    opening_m: float = OPEN_M
    target_m: float = OPEN_M
    closed_on: int = 0

    @property
    def moving(self) -> bool:
        """Whether the fingers are still on their way."""
        return self.opening_m != self.target_m

    def command(self, grip: Grip, rod: Rod) -> None:
        """Start opening or closing; what lies between the fingers now will be taken."""
        rod.release_hand(self.arm)
        self.closed_on = 0
        if grip != "open":
            rod.close_hand(self.arm, grip, self.opening_m, FINGER_DEPTH_M, FINGER_WIDTH_M)
            self.closed_on = len(rod.held_nodes(self.arm))
        self.target_m = self._target(grip, 2.0 * rod.parameters.radius_m)

    def advance(self, duration_s: float) -> None:
        """Move the fingers on; both move, each at its own speed."""
        reach_m = 2.0 * FINGER_SPEED_M_S * duration_s
        left_m = self.target_m - self.opening_m
        if abs(left_m) <= reach_m:
            self.opening_m = self.target_m
        else:
            self.opening_m += math.copysign(reach_m, left_m)

    def _target(self, grip: Grip, diameter_m: float) -> float:
        taken_m = self.closed_on * diameter_m + _SLACK_M if self.closed_on else 0.0
        return {"open": OPEN_M, "cage": max(CAGE_M, taken_m), "pinch": taken_m}[grip]
