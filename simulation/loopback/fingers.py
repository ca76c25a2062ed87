"""Fingers that close at their own speed, as far as what is between them lets them."""

from robots.descriptions.yumi import CAGE_OPENING_M, FINGER_SPEED_M_S, OPEN_OPENING_M
from robots.interfaces import Grip

_TARGETS_M: dict[Grip, float] = {"open": OPEN_OPENING_M, "cage": CAGE_OPENING_M, "pinch": 0.0}


class Fingers:
    """One gripper, open at first.

    Attributes:
        opening_m: Distance between the fingers.
    """

    def __init__(self, between_m: float) -> None:
        """Take the width of what is between the fingers, 0 for nothing."""
        self._between_m = between_m
        self._grip: Grip = "open"
        self.opening_m = OPEN_OPENING_M

    @property
    def moving(self) -> bool:
        """Whether they are on their way."""
        return self.opening_m != self._target_m()

    @property
    def holding(self) -> bool:
        """Whether they are closed around something."""
        return self._grip != "open" and self._between_m > 0.0

    def command(self, grip: Grip) -> None:
        """Send them on their way."""
        self._grip = grip

    def advance(self, duration_s: float) -> None:
        """Move on."""
        reach_m = 2.0 * FINGER_SPEED_M_S * duration_s
        left_m = self._target_m() - self.opening_m
        near = abs(left_m) <= reach_m
        self.opening_m += left_m if near else reach_m * (1 if left_m > 0.0 else -1)
        if near:
            self.opening_m = self._target_m()

    def _target_m(self) -> float:
        return max(_TARGETS_M[self._grip], 0.0 if self._grip == "open" else self._between_m)
