"""All moves of a seen object that look possible, by what is seen of the others."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from perception.shelf.casting import BoxCaster
from perception.shelf.planning.free_floor import FreeFloor
from perception.shelf.planning.moves import Move, Place, Push
from perception.shelf.planning.room import (
    Reach,
    blade_fits,
    fits_at,
    footprints,
    push_room_m,
    way_out,
)
from perception.shelf.types import Box, Floats, Shelf, ShelfView, Sighting

# Distance of the ends of pushes, and of places, that are compared.
PUSH_STEP_M = 0.02
PLACE_STEP_M = (0.025, 0.04)
# A shorter push is not worth an action.
LEAST_PUSH_M = 0.01


@dataclass(frozen=True, slots=True)
class Option:
    """A move, and where its object would stand.

    Attributes:
        move: What to do.
        box: The object afterwards.
        far_m: How far it goes.
    """

    move: Move
    box: Box
    far_m: float


def options(
    sighting: Sighting,
    seen: Sequence[Sighting],
    view: ShelfView,
    shelf: Shelf,
    caster: BoxCaster,
    reach: Reach,
    met: Floats,
) -> list[Option]:
    """Return pushes of several lengths to both sides, and free places for the suction cup.

    Args:
        sighting: The object to move.
        seen: All objects in view, itself included.
        view: What is seen.
        shelf: The shelf.
        caster: Rays of the view's camera.
        reach: What the tool needs.
        met: Footprints of what is in the way unseen, shape (M, 4).
    """
    own = footprints([sighting.box])[0]
    others = footprints([other.box for other in seen if other.label != sighting.label])
    others = np.vstack([others, met])
    found = list(_pushes(sighting, own, others, shelf, reach))
    if reach.suction and way_out(own, others):
        floor = FreeFloor(view, shelf, caster, own)
        found += _places(sighting, own, others, shelf, floor)
    return found


def _pushes(
    sighting: Sighting, own: Floats, others: Floats, shelf: Shelf, reach: Reach
) -> Iterator[Option]:
    box = sighting.box
    for sign in (-1, 1):
        if not blade_fits(own, others, sign, shelf, reach):
            continue
        room_m = push_room_m(own, others, sign, shelf, reach)
        for far_m in {*np.arange(PUSH_STEP_M, room_m, PUSH_STEP_M).tolist(), room_m}:
            if far_m >= LEAST_PUSH_M:
                shift_m = sign * far_m
                yield Option(
                    Push(sighting.label, shift_m), box.at(box.x_m + shift_m, box.y_m), far_m
                )


def _places(
    sighting: Sighting, own: Floats, others: Floats, shelf: Shelf, floor: FreeFloor
) -> list[Option]:
    box = sighting.box
    half = 0.5 * np.array(box.size_m[:2])
    x_m = np.arange(half[0], shelf.width_m - half[0] + 1e-9, PLACE_STEP_M[0])
    y_m = np.arange(shelf.depth_m - half[1], half[1] - 1e-9, -PLACE_STEP_M[1])
    grid = np.stack(np.meshgrid(x_m, y_m, indexing="ij"), axis=-1).reshape(-1, 2)
    places = np.hstack([grid - half, grid + half])
    fine = fits_at(places, others, shelf) & floor.holds(places)
    fine &= np.abs(grid - 0.5 * (own[:2] + own[2:])).max(axis=1) >= LEAST_PUSH_M
    return [
        Option(
            Place(sighting.label, float(x), float(y)),
            box.at(float(x), float(y)),
            float(np.hypot(x - box.x_m, y - box.y_m)),
        )
        for x, y in grid[fine]
    ]
