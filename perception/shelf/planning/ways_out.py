"""How to get a seen object out: what stands before it is moved away, one object after another."""

import numpy as np

from perception.shelf.planning.kernels import moves_from
from perception.shelf.planning.looking_ahead import Situation, kernel_inputs, named_move
from perception.shelf.planning.moves import Move
from perception.shelf.planning.room import footprints, front_lane, overlapping
from perception.shelf.types import Bools, Floats

# Of two moves that clear as much, the shorter one.
HASTE_1_M = 0.1
# By how much an object may stand elsewhere than where it was seen, to be tried one by one.
MARGINS_M = (0.0, 0.008, 0.02)


def freeing_move(situation: Situation, label: str) -> Move | None:
    """Return a move that leaves less in front of an object.

    Args:
        situation: What is known; the object itself is not to be movable.
        label: The object that is to come out straight.

    Returns:
        The move, or None when nothing stands in front, or nothing there can be moved away.
    """
    rows = footprints(list(situation.boxes))
    lane, blocked = _blocked(rows, situation.labels.index(label))
    if not blocked.any():
        return None
    inputs = kernel_inputs(situation)
    moved, by_cup, corners = moves_from(
        inputs.boxes, situation.movable, inputs.met, inputs.shelf_m, inputs.reach,
        inputs.steps_m, inputs.floor, situation.cell_m,
    )  # fmt: skip
    costs = _costs(rows, lane, moved, corners)
    helpful = blocked[moved] & (costs < 1.0)
    if not helpful.any():
        helpful = _unblocking(rows, blocked, moved, corners)
    if not helpful.any():
        return None
    pick = int(np.flatnonzero(helpful)[np.argmin(costs[helpful])])
    return named_move(situation, int(moved[pick]), bool(by_cup[pick]), corners[pick])


def _blocked(rows: Floats, own: int) -> tuple[Floats, Bools]:
    """Return the lane that has to be free, and which objects stand in it.

    Where none seems to, the lane is taken to be wider: places are known to some millimetres.
    """
    lane, blocked = front_lane(rows[own]), np.zeros(len(rows), dtype=bool)
    for margin_m in MARGINS_M:
        wider = lane + margin_m * np.array([-1.0, 0.0, 1.0, 0.0])
        blocked = overlapping(wider, rows)
        blocked[own] = False
        if blocked.any():
            return wider, blocked
    return lane, blocked


def _costs(rows: Floats, lane: Floats, moved: np.ndarray, corners: Floats) -> Floats:
    """Return 1 for moves that end in the lane, and a little for how far they go, shape (M,)."""
    sizes = rows[moved, 2:] - rows[moved, :2]
    after = np.hstack([corners, corners + sizes])
    far_m = np.abs(corners - rows[moved, :2]).sum(axis=1)
    costs: Floats = overlapping(lane, after).astype(np.float64) + HASTE_1_M * far_m
    return costs


def _unblocking(rows: Floats, blocked: Bools, moved: np.ndarray, corners: Floats) -> Bools:
    """Say which moves take something away from beside or before what blocks the lane."""
    helpful = np.zeros(len(moved), dtype=bool)
    for row in rows[blocked]:
        front = front_lane(row)
        wide = np.array([row[0] - (row[2] - row[0]), -1.0, row[2] + (row[2] - row[0]), row[3]])
        near = overlapping(wide, rows[moved]) & ~blocked[moved]
        sizes = rows[moved, 2:] - rows[moved, :2]
        after = np.hstack([corners, corners + sizes])
        helpful |= near & ~overlapping(front, after)
    return helpful
