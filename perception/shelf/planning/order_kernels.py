"""The compiled part of partings and of proofs: what the order that pushes along a shelf keep means.

Things are rows (x low, y low, x high, y high, height) [m]. All kernels live in this one file: the
compiler's cache looks only at the file of the function that is called.
"""

import numpy as np

from perception.shelf.planning.kernels import Ints, kernel
from perception.shelf.types import Bools, Floats

TOUCH_M = 1e-6
# With more objects across one line of sight, it is not thought of.
MOST_ACROSS = 6


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
    clear_m: float,
    sight: float,
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
        clear_m: What goes aside leaves so much on its side of the line.
        sight: The line ends at this share of the target's height.
    """
    count = len(things)
    half, now = 0.5 * (things[:, 2] - things[:, 0]), 0.5 * (things[:, 0] + things[:, 2])
    apart = least_apart(things, half, now, gap_m)
    counts, places = np.full(len(slopes), -1), np.empty((len(slopes), count))
    low, high = np.empty(count), np.empty(count)
    for line in range(len(slopes)):
        top = tops[line] - (1.0 - sight) * (tops[line] + eye[2] / depths[line])
        _across(things, half, eye, slopes[line], depths[line], top, clear_m, low, high)
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
    clear_m: float,
    low: Floats,
    high: Floats,
) -> None:
    """Write between which places of its middle each thing hides a target in one line of sight."""
    for index in range(len(things)):
        begin, end = _hidden_between(things[index], half[index], slope, top, depth, eye)
        low[index], high[index] = begin - clear_m, end + clear_m


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


@kernel
def any_shows(
    boxes: Floats,
    target: int,
    stays: Bools,
    pairs: Ints,
    rays: Floats,
    depths: Floats,
    eye: Floats,
    width_m: float,
    gap_m: float,
) -> bool:
    """Say whether two pixels of a target can show at a time; see `proofs`.

    Args:
        boxes: Rows (x low, y low, x high, y high, height), shape (B, 5).
        target: Which of them it is.
        stays: Which of them stay where they are, the target among them, shape (B,).
        pairs: Which two pixels, the same one twice for one alone, shape (Q, 2).
        rays: Through the target's pixels, shape (P, 3).
        depths: How far along each it is, shape (P,).
        eye: Position of the camera, shape (3,).
        width_m: Width of the shelf.
        gap_m: What stays between objects.
    """
    count = len(boxes)
    half, middle = 0.5 * (boxes[:, 2] - boxes[:, 0]), 0.5 * (boxes[:, 0] + boxes[:, 2])
    low, high = np.minimum(half, middle), np.maximum(width_m - half, middle)
    low[stays], high[stays] = middle[stays], middle[stays]
    apart = least_apart(boxes, half, middle, gap_m)
    begin, end = np.empty((2, count)), np.empty((2, count))
    for pair in range(len(pairs)):
        for side in range(2):
            pixel = pairs[pair, side]
            ray, depth = rays[pixel], depths[pixel] * rays[pixel, 1]
            for index in range(count):
                begin[side, index], end[side, index] = np.inf, -np.inf
                if index != target:
                    begin[side, index], end[side, index] = _hidden_between(
                        boxes[index], half[index], ray[0] / ray[1], ray[2] / ray[1], depth, eye
                    )
        if _leftmost(apart, low, high, begin, end):
            return True
    return False


@kernel
def _leftmost(apart: Floats, low: Floats, high: Floats, begin: Floats, end: Floats) -> bool:
    """Say whether all find a place that is out of their intervals, each as far left as it can."""
    x, changed = low.copy(), True
    while changed:
        changed = False
        for index in range(len(x)):
            least = x[index]
            for other in range(len(x)):
                least = max(least, x[other] + apart[other, index])
            for side in (0, 1, 0):
                if begin[side, index] + TOUCH_M < least < end[side, index] - TOUCH_M:
                    least = end[side, index]
            if least > high[index] + TOUCH_M:
                return False
            if least > x[index] + TOUCH_M:
                x[index], changed = least, True
    return True


@kernel
def least_apart(things: Floats, half: Floats, now: Floats, gap_m: float) -> Floats:
    """Return how far right of another the middle of each thing stays, shape (T, T)."""
    count = len(things)
    apart = np.full((count, count), -np.inf)
    for one in range(count):
        for other in range(count):
            deep = min(things[one, 3], things[other, 3]) - max(things[one, 1], things[other, 1])
            if one != other and deep > TOUCH_M and now[one] < now[other]:
                # What stands closer than the gap already may stay so.
                wide = half[one] + half[other] + gap_m
                apart[one, other] = min(wide, now[other] - now[one])
    return apart


@kernel
def _hidden_between(
    thing: Floats, half: float, slope: float, rise: float, depth: float, eye: Floats
) -> tuple[float, float]:
    """Return between which places of its middle a thing cuts a line of sight before some depth.

    Args:
        thing: Row (x low, y low, x high, y high, height).
        half: Half its width.
        slope: Direction of the line, x over depth.
        rise: The same upwards.
        depth: Where the line ends.
        eye: Where it begins, shape (3,).

    Returns:
        Low and high end; infinite, and the other way round, where it never does.
    """
    near, far = thing[1] - eye[1], min(thing[3] - eye[1], depth)
    above = thing[4] - eye[2]
    # The line rises with depth by its elevation: it is above the thing where that is lower.
    if rise > 0.0:
        far = min(far, above / rise)
    elif rise < 0.0 and above < 0.0:
        near = max(near, above / rise)
    elif above < 0.0:
        return np.inf, -np.inf
    if near >= far - TOUCH_M:
        return np.inf, -np.inf
    one, other = eye[0] + slope * near, eye[0] + slope * far
    return min(one, other) - half, max(one, other) + half
