"""Whether a cup will hold an object: by what it takes, and by what packages of that size weigh."""

import numpy as np

from perception.shelf.planning.room import Reach
from perception.shelf.types import Size

# What goods in packages weigh, from tissues to full bottles; anything between is as likely.
DENSITY_KG_M3 = (100.0, 600.0)
GRAVITY_M_S2 = 9.81
# What will not come is as many moves as so many.
MOST_TRIES = 10.0


def slip_chance(size_m: Size, reach: Reach) -> float:
    """Return how likely an object comes off the cup, which takes hold of the middle of its front.

    Args:
        size_m: Its width, depth and height.
        reach: What the cup takes.
    """
    lever_m = 0.5 * size_m[1]
    most_kg = min(reach.lift_kg, reach.lift_nm / (GRAVITY_M_S2 * lever_m))
    most_kg_m3 = most_kg / float(np.prod(size_m))
    low, high = DENSITY_KG_M3
    return float(np.clip((high - most_kg_m3) / (high - low), 0.0, 1.0))


def tries(size_m: Size, reach: Reach) -> float:
    """Return how many moves a change of place by the cup is worth, as it may fail.

    It is worth a try where any other way takes more than 1 / (1 - p) moves, when it fails with
    probability p.

    Args:
        size_m: See `slip_chance`.
        reach: The same.
    """
    return min(1.0 / max(1.0 - slip_chance(size_m, reach), 1e-9), MOST_TRIES)
