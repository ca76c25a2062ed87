"""Restoring order: objects go back to where they were first seen."""

from collections.abc import Mapping

import numpy as np

from perception.shelf.planning.looking_ahead import Situation
from perception.shelf.planning.moves import Move, Place, Push
from perception.shelf.planning.room import (
    blade_fits,
    fits_at,
    footprints,
    push_room_m,
    way_out,
)
from perception.shelf.types import Box, stands_on

# An object this close to its place stands there.
CLOSE_M = 0.02
# What is no farther from its row can be pushed back along it.
ROW_M = 0.01


def tidying_move(situation: Situation, first: Mapping[str, Box]) -> Move | None:
    """Return a move that brings an object back to its place; what stood on another stays below.

    Args:
        situation: What is known.
        first: Where each object stood first.

    Returns:
        The move of the object that has the farthest to go and can go, or None.
    """
    away = [
        (abs(box.x_m - first[label].x_m) + abs(box.y_m - first[label].y_m), label)
        for label, box in zip(situation.labels, situation.boxes, strict=True)
        if label in first and first[label].bottom_m == 0.0
    ]
    for far_m, label in sorted(away, reverse=True):
        if far_m <= CLOSE_M:
            return None
        move = _back(situation, label, first[label])
        if move is not None:
            return move
    return None


def _back(situation: Situation, label: str, home: Box) -> Move | None:
    shelf, reach = situation.shelf, situation.reach
    index = situation.labels.index(label)
    boxes = list(situation.boxes)
    box = boxes[index]
    # What stands on it goes along with a push; it is not lifted.
    laden = any(stands_on(one, box) for one in boxes)
    others = footprints([one for one in boxes if one is not box and not stands_on(one, box)])
    own, others = footprints([box])[0], np.vstack([others, situation.met])
    shift_m = home.x_m - box.x_m
    if abs(home.y_m - box.y_m) <= ROW_M:
        sign = 1 if shift_m > 0.0 else -1
        free = blade_fits(own, others, sign, shelf, reach)
        if free and push_room_m(own, others, sign, shelf, reach) >= abs(shift_m):
            return Push(label, shift_m)
    place = footprints([box.at(home.x_m, home.y_m)])
    if (
        reach.suction
        and not laden
        and way_out(own, others)
        and bool(fits_at(place, others, shelf)[0])
    ):
        return Place(label, home.x_m, home.y_m)
    return None
