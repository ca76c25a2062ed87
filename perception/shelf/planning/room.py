"""Room on a shelf: what a blade can push how far, and what a suction cup can take and put where.

The tool is the bluction tool, a thin blade with a suction cup at its tip (thesis, sections 5.2 and
7.5). Everything is judged on footprints, whatever the heights: tools and carried objects come in
from the front, low. Footprints are rows (x low, y low, x high, y high) [m] in the shelf's frame.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from perception.shelf.types import TOUCH_M, Bools, Box, Floats, Shelf

# Places are known to some millimetres: by how much what stands beside a way may be in it.
WIDER_M = 0.02
# Somewhere before the shelf.
OUTSIDE_M = -1.0


@dataclass(frozen=True, slots=True)
class Reach:
    """What the tool needs.

    Attributes:
        blade_m: Thickness of the blade that goes in beside an object; 0 asks for no lane, as in
            simulators of first order.
        overlap_m: How far along the object's side the blade must reach to push it.
        gap_m: What stays between a pushed object and what stopped it.
        suction: Whether there is a cup, so that objects can be taken out and put elsewhere.
        by_sight: Whether only what the latest look shows can be moved (thesis, section 5.2); arms
            that go by touch can move what they know of.
        lift_kg: What the cup lifts, when that is close to its lips.
        lift_nm: The greatest moment about its lips that it takes, of what hangs out before them.
    """

    blade_m: float = 0.01
    overlap_m: float = 0.02
    gap_m: float = 0.002
    suction: bool = True
    by_sight: bool = False
    lift_kg: float = float("inf")
    lift_nm: float = float("inf")


def footprints(boxes: Sequence[Box]) -> Floats:
    """Return footprints of boxes, shape (N, 4)."""
    rows = [(*box.low_m[:2], *box.high_m[:2]) for box in boxes]
    return np.array(rows, dtype=np.float64).reshape(-1, 4)


def overlapping(one: Floats, others: Floats) -> Bools:
    """Say which of the others' footprints (..., 4) one footprint overlaps by more than touch."""
    low = np.maximum(one[..., :2], others[..., :2])
    high = np.minimum(one[..., 2:], others[..., 2:])
    return np.asarray(((high - low) > TOUCH_M).all(axis=-1))


def blade_fits(moved: Floats, others: Floats, sign: int, shelf: Shelf, reach: Reach) -> bool:
    """Say whether the blade can come in at the side from which it pushes.

    Args:
        moved: Footprint of the object, shape (4,).
        others: All other footprints, shape (N, 4).
        sign: +1 to push along x, -1 against it.
        shelf: The shelf.
        reach: What the tool needs.
    """
    if reach.blade_m == 0.0:
        return True
    lane = blade_lane(moved, sign, reach)
    if lane[0] < -TOUCH_M or lane[2] > shelf.width_m + TOUCH_M:
        return False
    return not bool(overlapping(lane, others).any())


def blade_lane(moved: Floats, sign: int, reach: Reach) -> Floats:
    """Return the footprint that the blade passes over on its way in, shape (4,)."""
    side_m = moved[0] if sign > 0 else moved[2]
    low_m, high_m = sorted((side_m, side_m - sign * reach.blade_m))
    deep_m = moved[1] + min(reach.overlap_m, moved[3] - moved[1])
    return np.array([low_m, OUTSIDE_M, high_m, deep_m])


def front_lane(moved: Floats) -> Floats:
    """Return the footprint that an object passes over on its way out, shape (4,)."""
    return np.array([moved[0], OUTSIDE_M, moved[2], moved[1]])


def push_room_m(moved: Floats, others: Floats, sign: int, shelf: Shelf, reach: Reach) -> float:
    """Return how far an object can be pushed until it would touch another one or the wall."""
    beside = (np.minimum(moved[3], others[:, 3]) - np.maximum(moved[1], others[:, 1])) > TOUCH_M
    # Places are known to some millimetres: what seems to overlap stands there all the same.
    beside &= sign * (others[:, [0, 2]].sum(axis=1) - moved[[0, 2]].sum()) >= 0.0
    if sign > 0:
        ahead, wall_m = others[beside, 0] - moved[2], shelf.width_m - moved[2]
    else:
        ahead, wall_m = moved[0] - others[beside, 2], moved[0]
    return float(max(0.0, min([wall_m, *(ahead - reach.gap_m)])))


def way_out(moved: Floats, others: Floats) -> bool:
    """Say whether nothing stands in front of an object, so that it comes out straight."""
    return not bool(overlapping(front_lane(moved), others).any())


def fits_at(places: Floats, others: Floats, shelf: Shelf) -> Bools:
    """Say at which places an object can be put down from the front.

    Args:
        places: Footprints of the object where it would stand, shape (K, 4).
        others: Footprints of all others, shape (N, 4).
        shelf: The shelf.

    Returns:
        Whether it stands inside, on nothing else, with nothing in front of it, shape (K,).
    """
    inside = (places[:, :2] >= -TOUCH_M).all(axis=1)
    inside &= places[:, 2] <= shelf.width_m + TOUCH_M
    inside &= places[:, 3] <= shelf.depth_m + TOUCH_M
    swept = places.copy()
    swept[:, 1] = OUTSIDE_M
    return inside & ~overlapping(swept[:, None, :], others[None, :, :]).any(axis=1)
