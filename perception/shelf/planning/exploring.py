"""Where no moves show the target: look into what has not been seen yet.

What is hidden there is in the way of pushes, and is not moved before it is seen. So a small thing
is looked for wherever none has been ruled out, as the target is looked for: first of all where
moves have met something.
"""

from dataclasses import replace

import numpy as np

from perception.shelf.hidden_poses import PoseRules
from perception.shelf.planning.looking_ahead import Situation
from perception.shelf.types import Bools, Floats, Size

# The least thing that is looked for, and how finely.
THING_M: Size = (0.04, 0.04, 0.08)
RULES = PoseRules(cell_m=(0.015, 0.02))
# What all such things have in common that stand somewhere in a cell.
CORE_M: Size = (THING_M[0] - RULES.cell_m[0], THING_M[1] - RULES.cell_m[1], THING_M[2])
# Where moves have met something, it is so much likelier.
MET = 10.0
# How far around what was met.
AROUND_M = 0.02


def unseen_things(situation: Situation) -> Situation | None:
    """Return the situation in which a small thing is looked for that may be anywhere unseen.

    Args:
        situation: What is known.

    Returns:
        The same with other places, weights and target; None where all has been seen.
    """
    places_m = situation.unseen_m
    if not len(places_m):
        return None
    weights = np.where(_near(places_m, situation.met), MET, 1.0)
    weights, none = weights / weights.sum(), np.zeros(0)
    return replace(situation, target_m=CORE_M, places_m=places_m, weights=weights, belied=none)


def _near(places_m: Floats, met: Floats) -> Bools:
    x_m, y_m = places_m[:, :1], places_m[:, 1:]
    inside = (x_m > met[:, 0] - AROUND_M) & (x_m < met[:, 2] + AROUND_M)
    inside &= (y_m > met[:, 1] - AROUND_M) & (y_m < met[:, 3] + AROUND_M)
    return np.asarray(inside.any(axis=1))
