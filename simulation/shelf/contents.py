"""What stands on a shelf, and what pushes and the suction cup make of it; nothing falls by itself.

The assumptions are the thesis's (section 5.2): an action moves one object, and pushes stop at
contact. A push that meets the hidden target stops there like any other. What stands on another
object goes along with it when that is pushed, which is slow; it is taken by the cup alone, and what
carries it is not lifted.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from perception.shelf.planning.room import (
    Reach,
    blade_fits,
    fits_at,
    footprints,
    push_room_m,
    way_out,
)
from perception.shelf.types import LEVEL_M, Box, Floats, Shelf, stands_on
from simulation.shelf.scenes import Scene

# A push that moves an object by less has moved nothing.
LEAST_SHIFT_M = 0.001


class MoveFailure(StrEnum):
    """Why an action did nothing."""

    NOT_SEEN = "shelf.not_seen"
    NO_SUCTION = "suction.no_cup"
    OBSTRUCTED = "suction.obstructed"
    NO_PLACE = "suction.no_place"
    NO_BLADE = "push.no_room_for_blade"
    NO_ROOM = "push.blocked"
    NOTHING_THERE = "push.nothing_there"
    MISSED = "suction.missed"
    LOST = "suction.lost"


@dataclass(frozen=True, slots=True)
class MoveResult:
    """What came of an action.

    Attributes:
        failure: Why nothing moved; None when something did.
        moved_m: How far the object went in a straight line.
        short_m: By how much a push stopped before it had gone as far as was asked.
    """

    failure: MoveFailure | None
    moved_m: float = 0.0
    short_m: float = 0.0


class ShelfContents:
    """Boxes by name, and how they move."""

    def __init__(self, scene: Scene, reach: Reach) -> None:
        """Put everything where the scene has it."""
        self.shelf: Shelf = scene.shelf
        self._reach = reach
        self._boxes = dict(zip(scene.names, scene.boxes, strict=True))

    @property
    def boxes(self) -> Mapping[str, Box]:
        """Where everything stands now."""
        return self._boxes

    def set_boxes(self, boxes: Mapping[str, Box]) -> None:
        """Put everything elsewhere; what is not named is gone."""
        self._boxes = dict(boxes)

    def push(self, label: str, shift_m: float) -> MoveResult:
        """Push an object along the shelf until it has gone that far or touches something."""
        box, others = self._boxes[label], self._others(label)
        moved, sign = footprints([box])[0], 1 if shift_m > 0.0 else -1
        if box.bottom_m > 0.0 or not blade_fits(moved, others, sign, self.shelf, self._reach):
            return MoveResult(MoveFailure.NO_BLADE)
        room_m = push_room_m(moved, others, sign, self.shelf, self._reach)
        went_m = min(abs(shift_m), room_m)
        if went_m < LEAST_SHIFT_M:
            return MoveResult(MoveFailure.NO_ROOM)
        for name in [label, *self._carried(label)]:
            one = self._boxes[name]
            self._boxes[name] = one.at(one.x_m + sign * went_m, one.y_m)
        return MoveResult(None, went_m, abs(shift_m) - went_m)

    def place(self, label: str, x_m: float, y_m: float) -> MoveResult:
        """Take an object out straight and put it down elsewhere."""
        box = self._boxes[label]
        failure = self._comes_out(label)
        if failure is not None:
            return MoveResult(failure)
        put = box.on_floor(x_m, y_m)
        others = footprints([one for name, one in self._boxes.items() if name != label])
        if not fits_at(footprints([put]), others, self.shelf)[0]:
            return MoveResult(MoveFailure.NO_PLACE)
        self._boxes[label] = put
        return MoveResult(None, float(np.hypot(x_m - box.x_m, y_m - box.y_m)))

    def take_out(self, label: str) -> MoveResult:
        """Take an object out of the shelf for good."""
        failure = self._comes_out(label)
        if failure is not None:
            return MoveResult(failure)
        box = self._boxes.pop(label)
        return MoveResult(None, box.y_m)

    def topple(self, label: str, sign: int) -> bool:
        """Let an object fall over along the shelf, if there is room for it to lie; say whether."""
        box = self._boxes[label]
        width_m, depth_m, height_m = box.size_m
        edge_m = box.x_m + sign * 0.5 * width_m
        fallen = Box(edge_m + sign * 0.5 * height_m, box.y_m, (height_m, depth_m, width_m))
        row = footprints([fallen])
        inside = row[0, 0] >= 0.0 and row[0, 2] <= self.shelf.width_m
        laden = bool(self._carried(label)) or box.bottom_m > 0.0
        if laden or not inside or height_m <= width_m or not self._free(label, row):
            return False
        self._boxes[label] = fallen
        return True

    def drop(self, label: str) -> None:
        """Let a carried object fall: it comes to lie in front, on its side, if there is room."""
        box = self._boxes[label]
        width_m, depth_m, height_m = box.size_m
        lying = (height_m, depth_m, width_m) if height_m > width_m else box.size_m
        x_m = float(np.clip(box.x_m, 0.5 * lying[0], self.shelf.width_m - 0.5 * lying[0]))
        fallen = Box(x_m, 0.5 * lying[1], lying)
        if self._free(label, footprints([fallen])):
            self._boxes[label] = fallen

    def _free(self, label: str, row: Floats) -> bool:
        others = footprints([one for name, one in self._boxes.items() if name != label])
        wide = (np.minimum(row[0, 2:], others[:, 2:]) - np.maximum(row[0, :2], others[:, :2])) > 0.0
        return not bool(wide.all(axis=1).any())

    def _comes_out(self, label: str) -> MoveFailure | None:
        if not self._reach.suction:
            return MoveFailure.NO_SUCTION
        if self._carried(label) or not way_out(
            footprints([self._boxes[label]])[0], self._others(label)
        ):
            return MoveFailure.OBSTRUCTED
        return None

    def _carried(self, label: str) -> list[str]:
        """Return what stands on an object."""
        own = self._boxes[label]
        return [name for name, box in self._boxes.items() if stands_on(box, own)]

    def _others(self, label: str) -> Floats:
        """Return footprints of what may be in the way of an object, at whatever height it is."""
        own = self._boxes[label]
        return footprints(
            [
                box
                for name, box in self._boxes.items()
                if name != label
                and (own.bottom_m == 0.0 or box.high_m[2] > own.bottom_m + LEVEL_M)
                and not stands_on(box, own)
            ]
        )
