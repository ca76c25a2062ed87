"""How to get a seen object out: what stands before it is moved away, one object after another.

A search over short sequences of moves. What blocks the lane may be shut in itself, so objects
beside it are moved as well where that is what a sequence needs.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from perception.shelf.planning.kernels import moved_rows, moves_from
from perception.shelf.planning.looking_ahead import (
    KernelInputs,
    Situation,
    kernel_inputs,
    named_move,
    open_moves,
)
from perception.shelf.planning.moves import Move
from perception.shelf.planning.room import WIDER_M, footprints, front_lane, overlapping
from perception.shelf.types import Bools, Floats

# Of two sequences that clear as much, the shorter one: what a metre and what a move count beside
# a metre of blocked lane.
HASTE, MOVE = 1e-3, 1e-3
# By how much an object may stand elsewhere than where it was seen, to be tried one by one.
MARGINS_M = (0.0, 0.008, WIDER_M)
# Longest sequence, and how many of each length are gone on with.
LONGEST, BEAM = 3, 60
# A lane is clear when so little of it is blocked [m].
CLEAR_M = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class _Sequence:
    """Moves, where objects stand after them, and what they cost; `first` is none at the start."""

    boxes: Floats
    spent: float
    blocked_m: float
    first: tuple[int, bool, Floats] | None = None

    @property
    def cost(self) -> float:
        return self.spent + self.blocked_m


def freeing_move(situation: Situation, label: str, wider_m: float = WIDER_M) -> Move | None:
    """Return the first move of the best sequence that clears the way of an object.

    Args:
        situation: What is known; the object itself is not to be movable.
        label: The object that is to come out straight.
        wider_m: How much wider its lane is taken to be at most where nothing seems to block it.

    Returns:
        The move, or None when nothing stands in front, or no move helps.
    """
    rows = footprints(list(situation.boxes))
    lane, blocked = _blocked(rows, situation.labels.index(label), wider_m)
    if not blocked.any():
        return None
    inputs = kernel_inputs(situation)
    start = _Sequence(inputs.boxes, 0.0, _blocked_m(lane, inputs.boxes, blocked))
    best: _Sequence | None = None
    longer = [start]
    for _ in range(LONGEST):
        longer = [each for one in longer for each in _children(situation, inputs, lane, one)]
        longer = sorted(longer, key=lambda one: one.cost)[:BEAM]
        if not longer:
            break
        if longer[0].blocked_m < (best or start).blocked_m - CLEAR_M:
            best = longer[0]
        if best and best.blocked_m < CLEAR_M:
            break
    if best is None or best.first is None:
        return None
    index, by_cup, corner = best.first
    return named_move(situation, index, by_cup, corner)


def _children(
    situation: Situation, inputs: KernelInputs, lane: Floats, before: _Sequence
) -> Iterator[_Sequence]:
    """Yield a sequence with each move after it that may help."""
    rows = before.boxes[:, :4]
    blocked = overlapping(lane, rows) & (situation.movable != 0)
    moved, by_cup, corners = moves_from(
        before.boxes, situation.movable, inputs.met, inputs.shelf_m, inputs.reach,
        inputs.steps_m, inputs.floor, situation.cell_m,
    )  # fmt: skip
    helps = (blocked | _around(rows, blocked))[moved]
    helps &= open_moves(situation, before.boxes, (moved, by_cup, corners))
    for pick in np.flatnonzero(helps):
        index, corner = int(moved[pick]), corners[pick]
        boxes = moved_rows(before.boxes, index, corner)
        far_m = float(np.abs(corner - rows[index, :2]).sum())
        now_blocked = overlapping(lane, boxes[:, :4]) & (situation.movable != 0)
        yield _Sequence(
            boxes,
            before.spent + MOVE + HASTE * far_m,
            _blocked_m(lane, boxes, now_blocked),
            before.first or (index, bool(by_cup[pick]), corner),
        )


def _blocked(rows: Floats, own: int, wider_m: float) -> tuple[Floats, Bools]:
    """Return the lane that has to be free, and which objects stand in it.

    Where none seems to, the lane is taken to be wider: places are known to some millimetres.
    """
    lane, blocked = front_lane(rows[own]), np.zeros(len(rows), dtype=bool)
    for margin_m in (margin_m for margin_m in MARGINS_M if margin_m <= wider_m):
        wider = lane + margin_m * np.array([-1.0, 0.0, 1.0, 0.0])
        blocked = overlapping(wider, rows)
        blocked[own] = False
        if blocked.any():
            return wider, blocked
    return lane, blocked


def _blocked_m(lane: Floats, boxes: Floats, blocked: Bools) -> float:
    """Return how much of a lane's width objects take, each by itself [m]."""
    inside = np.minimum(boxes[blocked, 2], lane[2]) - np.maximum(boxes[blocked, 0], lane[0])
    return float(inside.sum())


def _around(rows: Floats, blocked: Bools) -> Bools:
    """Say which objects stand beside or before those that block the lane, shape (B,)."""
    around = np.zeros(len(rows), dtype=bool)
    for row in rows[blocked]:
        width_m = row[2] - row[0]
        around |= overlapping(np.array([row[0] - width_m, -1.0, row[2] + width_m, row[3]]), rows)
    return around
