"""Partings: pushes of several objects, as many as it takes, so that a target shows between them.

Pushes along the shelf keep the order of objects that stand in one another's way. To see a target in
one column of the image, each object that hides it there goes to the left or to the right of the
line of sight, and takes along what it meets. Of all such ways that with the fewest objects is found
for each column: more than a beam of short sequences would find where shelves are full.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from perception.shelf.planning.kernels import GAP, Ints, blade_fits
from perception.shelf.planning.order_kernels import least_apart, part_columns
from perception.shelf.planning.outlook import COARSE, Grain, Outlook
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
    grain: Grain = COARSE,
) -> Iterator[Parting]:
    """Yield ways to see a target that stands in one of some poses, different ones.

    Args:
        boxes: Objects that stand on the floor, as `kernels` has them, shape (B, 6).
        free: Which of them can be pushed, shape (B,).
        met: Footprints of what is in the way unseen, shape (M, 4).
        target_m: Width and depth of the target, which hidden things are pushed against, too.
        shelf_m: Width of the shelf, and what stays between a pushed object and what stops it.
        view: Where each pose shows.
        places_m: Where the target's middle is in each pose, shape (K, 2).
        poses: Which poses to see, by number.
        grain: How finely it is judged what shows.
    """
    walls = np.hstack([met, np.zeros((len(met), 1))])
    things = np.vstack([boxes[:, :5], walls, np.zeros((1, 5))])
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
            view.depth[entries], view.top[entries], grain.clear_m, grain.sight,
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
        boxes: Where they are, shape (B, 6).
        seen: Which are in view; none of the others goes first, shape (B,).
        met: Footprints of what is in the way unseen, shape (M, 4).
        width_m: Width of the shelf.
        reach: What the tool needs; see `kernels`.

    Returns:
        The pushes; none where the blade does not come in beside one of them, or none can begin.
    """
    now = boxes.copy()
    things = np.vstack([boxes[:, :5], np.hstack([met, np.zeros((len(met), 1))])])
    half_m, middle_m = 0.5 * (things[:, 2] - things[:, 0]), 0.5 * (things[:, 0] + things[:, 2])
    one_way = least_apart(things, half_m, middle_m, reach[GAP])
    apart = np.maximum(one_way, one_way.T)
    goal_m, ahead = parting.x_m, middle_m[None] > middle_m[: len(boxes), None]
    left = np.flatnonzero(np.abs(goal_m - middle_m[: len(boxes)]) > CLOSE_M).tolist()
    pushes: list[tuple[int, Floats]] = []
    while left:
        room_m = np.where(ahead[left], middle_m - goal_m[left, None], goal_m[left, None] - middle_m)
        goes = (room_m >= apart[left] - CLOSE_M).all(axis=1)
        able = [one for one, free in zip(left, goes, strict=True) if free and (pushes or seen[one])]
        signs = np.sign(goal_m - middle_m[: len(boxes)]).astype(int)
        index = next(
            (one for one in able if blade_fits(now, one, signs[one], met, width_m, reach)), None
        )
        if index is None:
            return []
        now[index, [0, 2]] += goal_m[index] - middle_m[index]
        middle_m[index] = goal_m[index]
        pushes.append((index, now[index, :2].copy()))
        left.remove(index)
    return pushes
