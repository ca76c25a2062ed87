"""The compiled part of looking ahead: what moves there are, and what each would show.

The camera is level, and everything stands on the floor or on what does. So in one column of the
image an object hides whatever is behind it up to the elevation of its top, the tangent of the angle
above the view, and a target shows there when its own elevation is greater than those of all before
it. Images are needed no more: a few thousand comparisons tell what a move would show. Views that
tilt are treated as level ones from the same place.

Objects are rows (x low, y low, x high, y high, top, bottom) [m]. What stands on another is wholly
above it, goes along with its pushes, and is moved by the cup alone. All kernels live in this one
file: the compiler's cache looks only at the file of the function that is called.
"""

import numba
import numpy as np
from numpy.typing import NDArray

from perception.shelf.types import LEVEL_M

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

kernel = numba.njit(cache=True, error_model="numpy")

TOUCH_M = 1e-6
# An object moves well that has room for this share of its width.
ROOMY = 1.0
# How many moves it takes to get an object out of the way: it moves well, or not at all; and the
# share of the same of what stops it.
MOVES_WELL, STUCK, STOPPED = 1.0, 2.4, 0.25
NO_DEPTH = np.inf
# Fields of `reach`: thickness of the blade, its overlap, what stays between, whether it has a cup.
BLADE, OVERLAP, GAP, SUCTION = 0, 1, 2, 3


@kernel
def _survey_one(box: Floats, slopes: Floats, eye: Floats, near: Floats, rise: Floats) -> None:
    """Write depth and elevation of one object in each column; `NO_DEPTH` where it is not."""
    front, back = box[1] - eye[1], box[3] - eye[1]
    for column in range(len(slopes)):
        slope = slopes[column]
        enter, leave = front, back
        if abs(slope) < 1e-12:
            if eye[0] < box[0] or eye[0] > box[2]:
                enter = NO_DEPTH
        else:
            one, other = (box[0] - eye[0]) / slope, (box[2] - eye[0]) / slope
            enter = max(enter, min(one, other))
            leave = min(leave, max(one, other))
        if enter < leave and enter > 0.0:
            above = box[4] - eye[2]
            near[column] = enter
            rise[column] = above / (leave if above < 0.0 else enter)
        else:
            near[column] = NO_DEPTH
            rise[column] = -np.inf


@kernel
def survey(boxes: Floats, slopes: Floats, eye: Floats) -> tuple[Floats, Floats]:
    """Return nearest depth and elevation of each object in each column, shape (B, C) each."""
    near = np.empty((len(boxes), len(slopes)))
    rise = np.empty((len(boxes), len(slopes)))
    for index in range(len(boxes)):
        _survey_one(boxes[index], slopes, eye, near[index], rise[index])
    return near, rise


@kernel
def _overlap(ax: float, ay: float, bx: float, by: float, other: Floats) -> bool:
    wide = min(bx, other[2]) - max(ax, other[0])
    deep = min(by, other[3]) - max(ay, other[1])
    return bool(wide > TOUCH_M and deep > TOUCH_M)


@kernel
def _beside(other: Floats, bottom: float) -> bool:
    """Say whether an object may be in the way of what stands at some height.

    On the floor what stands on another one is in the way where that one is.
    """
    if bottom > 0.0:
        return bool(other[4] > bottom + LEVEL_M)
    return bool(other[5] == 0.0)


@kernel
def _stands_on(upper: Floats, lower: Floats) -> bool:
    level = upper[5] > 0.0 and abs(upper[5] - lower[4]) <= LEVEL_M
    return level and _overlap(upper[0], upper[1], upper[2], upper[3], lower)


@kernel
def _laden(boxes: Floats, index: int) -> bool:
    """Say whether something stands on an object."""
    for other in range(len(boxes)):
        if other != index and _stands_on(boxes[other], boxes[index]):
            return True
    return False


@kernel
def blade_fits(
    boxes: Floats, index: int, sign: int, met: Floats, width_m: float, reach: Floats
) -> bool:
    """Say whether the blade can come in beside an object; see `room.blade_fits`."""
    own = boxes[index]
    if reach[BLADE] == 0.0:
        return True
    low = own[0] - reach[BLADE] if sign > 0 else own[2]
    high = low + reach[BLADE]
    deep = own[1] + min(reach[OVERLAP], own[3] - own[1])
    if low < -TOUCH_M or high > width_m + TOUCH_M:
        return False
    if own[5] > 0.0:
        return False
    return _front_free(boxes, index, 0.0, met, low, high, deep)


@kernel
def _ahead(own: Floats, other: Floats, sign: int, gap: float, room: float) -> float:
    if min(own[3], other[3]) - max(own[1], other[1]) <= TOUCH_M:
        return room
    # Places are known to some millimetres: what seems to overlap stands there all the same.
    ahead = sign * (other[0] + other[2] - own[0] - own[2]) >= 0.0
    if not ahead:
        return room
    return min(room, (other[0] - own[2] if sign > 0 else own[0] - other[2]) - gap)


@kernel
def room_beside(
    boxes: Floats, index: int, sign: int, met: Floats, width_m: float, reach: Floats
) -> float:
    """Return how far an object can be pushed; see `room.push_room_m`."""
    own = boxes[index]
    room = width_m - own[2] if sign > 0 else own[0]
    for other in range(len(boxes)):
        if other != index and _beside(boxes[other], own[5]):
            room = _ahead(own, boxes[other], sign, reach[GAP], room)
    for row in range(len(met)):
        room = _ahead(own, met[row], sign, reach[GAP], room)
    return max(0.0, room)


@kernel
def _front_free(
    boxes: Floats, index: int, bottom: float, met: Floats, low: float, high: float, deep: float
) -> bool:
    """Say whether nothing but one object stands before a line along the shelf, at some height."""
    for other in range(len(boxes)):
        if other == index or not _beside(boxes[other], bottom):
            continue
        if _overlap(low, -1.0, high, deep, boxes[other]):
            return False
    for row in range(len(met)):  # noqa: SIM110 - compiled
        if _overlap(low, -1.0, high, deep, met[row]):
            return False
    return True


@kernel
def _free_share(sums: Floats, cell_m: float, own: Floats, place: Floats) -> float:
    """Return the share of a footprint that is known to be free floor, or is the object's own."""
    last_x, last_y = sums.shape[0] - 1, sums.shape[1] - 1
    x0 = min(max(round(place[0] / cell_m), 0), last_x)
    y0 = min(max(round(place[1] / cell_m), 0), last_y)
    x1 = min(max(round(place[2] / cell_m), x0), last_x)
    y1 = min(max(round(place[3] / cell_m), y0), last_y)
    cells = (x1 - x0) * (y1 - y0)
    if cells == 0:
        return 0.0
    free = sums[x1, y1] - sums[x0, y1] - sums[x1, y0] + sums[x0, y0]
    wide = min(own[2], place[2]) - max(own[0], place[0])
    deep = min(own[3], place[3]) - max(own[1], place[1])
    if wide > 0.0 and deep > 0.0:
        free += wide * deep / (cell_m * cell_m)
    return free / cells


@kernel
def moves_from(
    boxes: Floats,
    movable: Ints,
    met: Floats,
    shelf_m: Floats,
    reach: Floats,
    steps_m: Floats,
    floor: Floats,
    cell_m: float,
) -> tuple[Ints, Ints, Floats]:
    """Return all moves: which object, whether by the cup, and where its low corner goes.

    Shapes are (M,), (M,) and (M, 2).

    Args:
        boxes: All objects, shape (B, 6).
        movable: Which of them may be moved: 1 yes, 2 by pushes alone, 3 by the cup alone, else no.
        met: What is in the way unseen, footprints, shape (M, 4).
        shelf_m: Width and depth of the shelf.
        reach: What the tool needs, in the order of the fields' numbers above.
        steps_m: Distance of ends of pushes, and of places along x and y.
        floor: Sums of cells of free floor, shape (nx + 1, ny + 1).
        cell_m: Size of such a cell.
    """
    which, ends = [(0, 0) for _ in range(0)], [(0.0, 0.0) for _ in range(0)]
    place = np.empty(4)
    for index in range(len(boxes)):
        if movable[index] not in (1, 2, 3):
            continue
        own = boxes[index]
        if movable[index] != 3:
            for sign in (-1, 1):
                if not blade_fits(boxes, index, sign, met, shelf_m[0], reach):
                    continue
                room = room_beside(boxes, index, sign, met, shelf_m[0], reach)
                if room < 0.01:
                    continue
                count = int(room / steps_m[0] + 0.5)
                for number in range(1, count):
                    which.append((index, 0))
                    ends.append((own[0] + sign * number * steps_m[0], own[1]))
                which.append((index, 0))
                ends.append((own[0] + sign * room, own[1]))
        if movable[index] == 2 or reach[SUCTION] == 0.0:
            continue
        if _laden(boxes, index):
            continue
        if not _front_free(boxes, index, own[5], met, own[0], own[2], own[1]):
            continue
        wide, deep = own[2] - own[0], own[3] - own[1]
        columns = max(2, int((shelf_m[0] - wide) / steps_m[1]) + 1)
        rows = max(2, int((shelf_m[1] - deep) / steps_m[2]) + 1)
        for column in range(columns):
            place[0] = (shelf_m[0] - wide) * column / (columns - 1)
            place[2] = place[0] + wide
            for row in range(rows):
                place[1] = (shelf_m[1] - deep) * row / (rows - 1)
                place[3] = place[1] + deep
                if abs(place[0] - own[0]) < 0.01 and abs(place[1] - own[1]) < 0.01:
                    continue
                if not _front_free(boxes, index, 0.0, met, place[0], place[2], place[3]):
                    continue
                if _free_share(floor, cell_m, own, place) >= 0.95:
                    which.append((index, 1))
                    ends.append((place[0], place[1]))
    moved, by_cup = np.empty(len(which), np.int64), np.empty(len(which), np.int64)
    corners = np.empty((len(which), 2))
    for number in range(len(which)):
        moved[number], by_cup[number] = which[number]
        corners[number, 0], corners[number, 1] = ends[number]
    return moved, by_cup, corners


@kernel
def _stopper(boxes: Floats, index: int, sign: int, room: float, gap: float) -> int:
    """Return which object stops a push, -1 for the wall or what was met."""
    own = boxes[index]
    for other in range(len(boxes)):
        if other == index or not _beside(boxes[other], own[5]):
            continue
        if _ahead(own, boxes[other], sign, gap, np.inf) <= room + TOUCH_M:
            return other
    return -1


@kernel
def _effort(boxes: Floats, movable: Ints, met: Floats, width_m: float, reach: Floats) -> Floats:
    """Return how many moves it takes to get each object out of the way, roughly.

    It falls with the room that an object has, and a little with the room of what stops it: where
    no few moves show anything, those are better that make room.
    """
    count = len(boxes)
    shares, stoppers = np.full((count, 2), -1.0), np.full((count, 2), -1)
    effort = np.full(count, STUCK)
    for index in range(count):
        own = boxes[index]
        lifted = movable[index] in (1, 3) and reach[SUCTION] > 0.0 and not _laden(boxes, index)
        if lifted and _front_free(boxes, index, own[5], met, own[0], own[2], own[1]):
            effort[index] = MOVES_WELL
        elif movable[index] in (1, 2):
            for side in range(2):
                sign = 2 * side - 1
                if blade_fits(boxes, index, sign, met, width_m, reach):
                    room = room_beside(boxes, index, sign, met, width_m, reach)
                    share = min(1.0, room / (ROOMY * (own[2] - own[0])))
                    shares[index, side] = share
                    stoppers[index, side] = _stopper(boxes, index, sign, room, reach[GAP])
                    effort[index] = min(effort[index], STUCK - (STUCK - MOVES_WELL) * share)
    whole = effort.copy()
    for index in range(count):
        if effort[index] > MOVES_WELL:
            least = STUCK
            for side in range(2):
                stopper = stoppers[index, side]
                if shares[index, side] >= 0.0 and stopper >= 0:
                    least = min(least, effort[stopper])
            whole[index] += STOPPED * (least - MOVES_WELL)
    return whole


@kernel
def _least_effort(costs: Floats, faces: Floats, count: int, enough: float) -> float:
    """Return the least effort for which columns show that are so much of a target together."""
    effort, left = 0.0, enough
    for _ in range(count):
        least = np.inf
        for entry in range(count):
            if faces[entry] > 0.0:
                least = min(least, costs[entry])
        for entry in range(count):
            if faces[entry] > 0.0 and costs[entry] <= least:
                left -= faces[entry]
                faces[entry] = 0.0
        effort = least
        if left <= 0.0:
            break
    return effort


@kernel
def _assess(
    near: Floats,
    rise: Floats,
    effort: Floats,
    eye: Floats,
    column: Ints,
    depth: Floats,
    top: Floats,
    start: Ints,
    shows: Floats,
    weights: Floats,
) -> tuple[float, float]:
    """Return the weight of the poses that show, and the effort that it takes to see the others."""
    shown = behind = 0.0
    costs, faces = np.empty(near.shape[1]), np.empty(near.shape[1])
    for cell in range(len(weights)):
        if weights[cell] <= 0.0:
            continue
        visible, count = 0.0, 0
        for entry in range(start[cell], start[cell + 1]):
            at = column[entry]
            # Where nothing is before it, a target shows down to the floor it stands on.
            foot = -eye[2] / depth[entry]
            highest, cost = foot, 0.0
            for index in range(len(near)):
                if near[index, at] < depth[entry]:
                    if rise[index, at] > highest:
                        highest = rise[index, at]
                    if rise[index, at] >= top[entry]:
                        cost += effort[index]
            if highest < top[entry]:
                visible += top[entry] - highest
            costs[count], faces[count] = cost, top[entry] - foot
            count += 1
        if visible >= shows[cell]:
            shown += weights[cell]
        else:
            least = _least_effort(costs, faces, count, shows[cell])
            behind += weights[cell] * max(least, MOVES_WELL)
    return shown, behind


@kernel
def rising(
    boxes: Floats,
    slopes: Floats,
    eye: Floats,
    column: Ints,
    depth: Floats,
    top: Floats,
    start: Ints,
    weights: Floats,
) -> Floats:
    """Return by how much each pose of a target rises above what is before it, shape (K,).

    Args:
        boxes: All objects, shape (B, 6).
        slopes: Direction of each column, x over depth, shape (C,).
        eye: Position of the camera, shape (3,).
        column: Column of each entry; an entry is a column of the target in one of its poses.
        depth: Depth of the target there.
        top: Its elevation there.
        start: First entry of each pose, and the end of the last, shape (K + 1,).
        weights: Probability of each pose, shape (K,); what has none is left out.
    """
    near, rise = survey(boxes, slopes, eye)
    rises = np.zeros(len(weights))
    for cell in range(len(weights)):
        if weights[cell] <= 0.0:
            continue
        for entry in range(start[cell], start[cell + 1]):
            at, highest = column[entry], -eye[2] / depth[entry]
            for index in range(len(near)):
                if near[index, at] < depth[entry] and rise[index, at] > highest:
                    highest = rise[index, at]
            if highest < top[entry]:
                rises[cell] += top[entry] - highest
    return rises


@kernel
def _shift(row: Floats, before: Floats, by: Floats) -> None:
    """Move an object along the floor, or put it there."""
    row[0], row[2] = before[0] + by[0], before[2] + by[0]
    row[1], row[3] = before[1] + by[1], before[3] + by[1]


@kernel
def moved_rows(boxes: Floats, index: int, corner: Floats) -> Floats:
    """Return objects after one of them was moved: what stands on it goes along, shape (B, 6).

    What stood on another one and was moved stands on the floor.
    """
    after = boxes.copy()
    for one in range(len(boxes)):
        if one == index or _stands_on(boxes[one], boxes[index]):
            _shift(after[one], boxes[one], corner - boxes[index, :2])
    after[index, 4] -= after[index, 5]
    after[index, 5] = 0.0
    return after


@kernel
def consider(
    boxes: Floats,
    movable: Ints,
    met: Floats,
    width_m: float,
    reach: Floats,
    slopes: Floats,
    eye: Floats,
    column: Ints,
    depth: Floats,
    top: Floats,
    start: Ints,
    shows: Floats,
    weights: Floats,
    moved: Ints,
    corners: Floats,
) -> tuple[Floats, Floats]:
    """Assess every move on its own: weight shown, and effort to see the rest, shape (M,) each.

    Args:
        boxes: All objects, shape (B, 6).
        movable: See `moves_from`.
        met: The same.
        width_m: Width of the shelf.
        reach: See `moves_from`.
        slopes: See `rising`.
        eye: The same.
        column: The same.
        depth: The same.
        top: The same.
        start: The same.
        shows: By how much a pose must rise above what is before it to be seen, shape (K,).
        weights: Probability of each pose, shape (K,).
        moved: Which object each move moves, shape (M,).
        corners: Where its low corner goes, shape (M, 2).
    """
    near, rise = survey(boxes, slopes, eye)
    after = boxes.copy()
    shown, behind = np.empty(len(moved)), np.empty(len(moved))
    for number in range(len(moved)):
        index = moved[number]
        for one in range(len(boxes)):
            if one == index or _stands_on(boxes[one], boxes[index]):
                _shift(after[one], boxes[one], corners[number] - boxes[index, :2])
                if one == index:
                    after[one, 4], after[one, 5] = boxes[one, 4] - boxes[one, 5], 0.0
                _survey_one(after[one], slopes, eye, near[one], rise[one])
        effort = _effort(after, movable, met, width_m, reach)
        shown[number], behind[number] = _assess(
            near, rise, effort, eye, column, depth, top, start, shows, weights
        )
        for one in range(len(boxes)):
            if one == index or _stands_on(boxes[one], boxes[index]):
                after[one] = boxes[one]
                _survey_one(after[one], slopes, eye, near[one], rise[one])
    return shown, behind
