"""Goals for tools that follow from other goals."""

from dataclasses import replace

import numpy as np

from robots.interfaces import Floats, TcpGoal


def above(goal: TcpGoal, clearance_m: float, *then_m: Floats) -> TcpGoal:
    """Return the goal from which a tool can go straight down onto `goal`, and on from there.

    Args:
        goal: Where the tool goes down to.
        clearance_m: Height above it.
        then_m: Straight motions that must be possible after that, one after the other.
    """
    down_m = np.array([0.0, 0.0, -clearance_m])
    return replace(goal, position_m=goal.position_m - down_m, onward_m=(down_m, *then_m))
