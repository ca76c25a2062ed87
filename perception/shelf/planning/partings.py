"""Partings: pushes of several objects, as many as it takes, so that a target shows between them.

Pushes along the shelf keep the order of objects that stand in one another's way. To see a target in
one column of the image, each object that hides it there goes to the left or to the right of the
line of sight, and takes along what it meets. Of all such ways that with the fewest objects is found
for each column: more than a beam of short sequences would find where shelves are full.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from perception.shelf.planning.kernels import Ints, blade_fits, room_beside
from perception.shelf.planning.order_kernels import part_columns
from perception.shelf.planning.outlook import Outlook
from perception.shelf.types import Bools, Floats

# Objects that are so close to where they are to be are there.
CLOSE_M = 0.004


@dataclass(frozen=True, slots=True, eq=False)
class Parting:
    """One way to see into one place.

    Attributes:
        count: How many objects go aside.
        x_m: Where the middle of each object is afterwards, shape (B,).
    """

    count: int
    x_m: Floats


def partings(
    boxes: Floats,
    free: Bools,
    met: Floats,
    target_m: tuple[float, float],
    shelf_m: tuple[float, float],
    view: Outlook,
    places_m: Floats,
    poses: Ints,
) -> Iterator[Parting]:
    """Yield ways to see a target that stands in one of some poses, different ones.

    Args:
        boxes: Objects, rows (x low, y low, x high, y high, height), shape (B, 5).
        free: Which of them can be pushed, shape (B,).
        met: Footprints of what is in the way unseen, shape (M, 4).
        target_m: Width and depth of the target, which hidden things are pushed against, too.
        shelf_m: Width of the shelf, and what stays between a pushed object and what stops it.
        view: Where each pose shows.
        places_m: Where the target's middle is in each pose, shape (K, 2).
        poses: Which poses to see, by number.
    """
    walls = np.hstack([met, np.zeros((len(met), 1))])
    things = np.vstack([boxes, walls, np.zeros((1, 5))])
    may_move = np.zeros(len(things), dtype=np.bool_)
    may_move[: len(boxes)] = free
    half = 0.5 * np.array(target_m)
    found: set[bytes] = set()
    for pose in poses.tolist():
        entries = np.arange(view.start[pose], view.start[pose + 1])
        if not len(entries):
            continue
        things[-1, :4] = np.hstack([places_m[pose] - half, places_m[pose] + half])
        counts, places = part_columns(
            things, may_move, shelf_m[0], shelf_m[1], view.eye, view.slopes[view.column[entries]],
            view.depth[entries], view.top[entries],
        )  # fmt: skip
        for entry in np.flatnonzero(counts > 0):
            x_m = places[entry, : len(boxes)]
            key = np.round(x_m, 3).tobytes()
            if key not in found:
                found.add(key)
                yield Parting(int(counts[entry]), x_m)


def pushes_of(
    parting: Parting, boxes: Floats, seen: Bools, met: Floats, width_m: float, reach: Floats
) -> list[tuple[int, Floats]]:
    """Return which objects to push one after the other, and where their low corners go.

    Args:
        parting: Where they are to be.
        boxes: Where they are, shape (B, 5).
        seen: Which are in view; none of the others goes first, shape (B,).
        met: Footprints of what is in the way unseen, shape (M, 4).
        width_m: Width of the shelf.
        reach: What the tool needs; see `kernels`.

    Returns:
        The pushes; none where the blade does not come in beside one of them, or none can begin.
    """
    now = boxes.copy()
    shifts_m = parting.x_m - 0.5 * (now[:, 0] + now[:, 2])
    left = np.flatnonzero(np.abs(shifts_m) > CLOSE_M).tolist()
    pushes: list[tuple[int, Floats]] = []
    while left:
        able = (one for one in left if pushes or seen[one])
        index = next(
            (one for one in able if _goes(now, one, shifts_m[one], met, width_m, reach)), None
        )
        if index is None:
            return []
        now[index, [0, 2]] += shifts_m[index]
        pushes.append((index, now[index, :2].copy()))
        left.remove(index)
    return pushes


def _goes(
    boxes: Floats, index: int, shift_m: float, met: Floats, width_m: float, reach: Floats
) -> bool:
    sign = 1 if shift_m > 0.0 else -1
    if not blade_fits(boxes, index, sign, met, width_m, reach):
        return False
    return bool(room_beside(boxes, index, sign, met, width_m, reach) >= abs(shift_m) - CLOSE_M)
