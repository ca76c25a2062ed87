"""Fingers that open and close at their own speed, and what they take hold of."""

import math

from robots.descriptions.yumi import CAGE_OPENING_M, FINGER_SPEED_M_S, OPEN_OPENING_M
from robots.interfaces import Arm, Grip
from simulation.cable.hands import DEPTH_M, WIDTH_M
from simulation.cable.rod import Rod

_SLACK_M = 0.0006  # closed fingers leave the cable to its grasp instead of pressing on it


class Gripper:
    """One hand's fingers.

    Attributes:
        opening_m: Distance between the fingers.
    """

    def __init__(self, arm: Arm, rod: Rod) -> None:
        """Begin open; the rod must know the hand by the arm's name."""
        self._arm, self._rod = arm, rod
        self._grip: Grip = "open"
        self.opening_m = OPEN_OPENING_M

    @property
    def strands(self) -> int:
        """How many strands of cable the fingers have between them; an overload tears them out."""
        return len(self._rod.held_nodes(self._arm))

    @property
    def moving(self) -> bool:
        """Whether the fingers are still on their way."""
        return self.opening_m != self._target_m()

    @property
    def grip(self) -> Grip:
        """What the fingers were last told to do."""
        return self._grip

    def take_state(self, grip: Grip, opening_m: float) -> None:
        """Stand as an empty gripper stood."""
        self._grip, self.opening_m = grip, opening_m

    def command(self, grip: Grip) -> None:
        """Start opening or closing; closing fingers take what is between them now."""
        self._rod.release_hand(self._arm)
        self._grip = grip
        if grip != "open":
            self._rod.close_hand(self._arm, grip, self.opening_m, DEPTH_M, WIDTH_M)

    def advance(self, duration_s: float) -> None:
        """Move both fingers on, each at its own speed."""
        reach_m = 2.0 * FINGER_SPEED_M_S * duration_s
        target_m = self._target_m()
        left_m = target_m - self.opening_m
        if abs(left_m) <= reach_m:
            self.opening_m = target_m
        else:
            self.opening_m += math.copysign(reach_m, left_m)

    def _target_m(self) -> float:
        """Return where the fingers are going: shut, or as close as what they hold lets them."""
        if self._grip == "open":
            return OPEN_OPENING_M
        diameter_m = 2.0 * self._rod.parameters.radius_m
        taken_m = self.strands * diameter_m + _SLACK_M if self.strands else 0.0
        return taken_m if self._grip == "pinch" else max(CAGE_OPENING_M, taken_m)
