"""Partings: pushes of several objects, as many as it takes, so that a target shows between them.

Pushes along the shelf keep the order of objects that stand in one another's way. To see a target in
one column of the image, each object that hides it there goes to the left or to the right of the
line of sight, and takes along what it meets. Of all such ways that with the fewest objects is found
for each column: more than a beam of short sequences would find where shelves are full.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from perception.shelf.planning.kernels import Ints, blade_fits, kernel, room_beside
from perception.shelf.planning.outlook import Outlook
from perception.shelf.types import Bools, Floats

TOUCH_M = 1e-6
# What goes aside leaves so much on its side of the line of sight.
CLEAR_M = 0.008
# Objects that are so close to where they are to be are there.
CLOSE_M = 0.004
# The line of sight ends at this share of the target's height.
SIGHT = 0.8
# With more objects across one line of sight, it is not thought of.
MOST_ACROSS = 6


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


@kernel
def part_columns(
    things: Floats,
    may_move: Bools,
    width_m: float,
    gap_m: float,
    eye: Floats,
    slopes: Floats,
    depths: Floats,
    tops: Floats,
) -> tuple[Ints, Floats]:
    """Return for each line of sight how many things go aside, -1 for none, and where all are then.

    Shapes are (E,) and (E, T).

    Args:
        things: Rows (x low, y low, x high, y high, height), shape (T, 5).
        may_move: Which of them can be pushed, shape (T,).
        width_m: Width of the shelf.
        gap_m: What stays between a pushed thing and what stops it.
        eye: Position of the camera, shape (3,).
        slopes: Direction of each line, x over depth, shape (E,).
        depths: Depth of the target there.
        tops: Its elevation there.
    """
    count = len(things)
    apart, now = np.full((count, count), -np.inf), np.empty(count)
    half = np.empty(count)
    for one in range(count):
        now[one] = 0.5 * (things[one, 0] + things[one, 2])
        half[one] = 0.5 * (things[one, 2] - things[one, 0])
    for one in range(count):
        for other in range(count):
            deep = min(things[one, 3], things[other, 3]) - max(things[one, 1], things[other, 1])
            if one != other and deep > TOUCH_M and now[one] < now[other]:
                # What stands closer than the gap already may stay so.
                wide = half[one] + half[other] + gap_m
                apart[one, other] = min(wide, now[other] - now[one])
    counts, places = np.full(len(slopes), -1), np.empty((len(slopes), count))
    low, high = np.empty(count), np.empty(count)
    for line in range(len(slopes)):
        _across(things, half, eye, slopes[line], depths[line], tops[line], low, high)
        counts[line] = _part(now, half, apart, may_move, width_m, low, high, places[line])
    return counts, places


@kernel
def _across(
    things: Floats,
    half: Floats,
    eye: Floats,
    slope: float,
    depth: float,
    top: float,
    low: Floats,
    high: Floats,
) -> None:
    """Write between which places of its middle each thing hides a target in one line of sight."""
    sight = top - (1.0 - SIGHT) * (top + eye[2] / depth)
    for index in range(len(things)):
        low[index], high[index] = np.inf, -np.inf
        near, far = things[index, 1] - eye[1], min(things[index, 3] - eye[1], depth)
        above = things[index, 4] - eye[2]
        # The line rises with depth by its elevation: it is above the thing where that is lower.
        if sight > 0.0:
            far = min(far, above / sight)
        elif sight < 0.0 and above < 0.0:
            near = max(near, above / sight)
        elif above < 0.0:
            continue
        if near >= far - TOUCH_M:
            continue
        one, other = eye[0] + slope * near, eye[0] + slope * far
        low[index] = min(one, other) - half[index] - CLEAR_M
        high[index] = max(one, other) + half[index] + CLEAR_M


@kernel
def _part(
    now: Floats,
    half: Floats,
    apart: Floats,
    may_move: Bools,
    width_m: float,
    low: Floats,
    high: Floats,
    places: Floats,
) -> int:
    """Send each thing across a line to one side or the other; return the fewest that move."""
    across = [0 for _ in range(0)]
    for index in range(len(now)):
        if low[index] + TOUCH_M < now[index] < high[index] - TOUCH_M:
            if not may_move[index]:
                return -1
            across.append(index)
    if len(across) > MOST_ACROSS:
        return -1
    best, best_m = -1, np.inf
    x, ways = np.empty(len(now)), np.empty(len(now), np.int64)
    for sides in range(2 ** len(across)):
        x[:], ways[:] = now, 0
        for bit in range(len(across)):
            index = across[bit]
            ways[index] = 1 if (sides >> bit) & 1 else -1
            x[index] = high[index] if ways[index] > 0 else low[index]
        if not _settled(x, ways, half, apart, may_move, width_m, low, high):
            continue
        moved = int((ways != 0).sum())
        far_m = np.abs(x - now).sum()
        if best < 0 or moved < best or (moved == best and far_m < best_m):
            best, best_m = moved, far_m
            places[:] = x
    return best


@kernel
def _settled(
    x: Floats,
    ways: Ints,
    half: Floats,
    apart: Floats,
    may_move: Bools,
    width_m: float,
    low: Floats,
    high: Floats,
) -> bool:
    """Let what moves take along what it meets; say whether all find room."""
    count, changed = len(x), True
    while changed:
        changed = False
        for one in range(count):
            inside = half[one] - TOUCH_M <= x[one] <= width_m - half[one] + TOUCH_M
            if ways[one] != 0 and not inside:
                return False
            for other in range(count):
                if x[other] - x[one] >= apart[one, other] - TOUCH_M:
                    continue
                if ways[one] > 0 and ways[other] >= 0 and may_move[other]:
                    ways[other], x[other] = 1, x[one] + apart[one, other]
                    if low[other] < x[other] < high[other]:
                        x[other] = high[other]
                elif ways[other] < 0 and ways[one] <= 0 and may_move[one]:
                    ways[one], x[one] = -1, x[other] - apart[one, other]
                    if low[one] < x[one] < high[one]:
                        x[one] = low[one]
                else:
                    return False
                changed = True
    return True
