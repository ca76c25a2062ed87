"""What moves have met without its being seen: it is in the way until something else is known."""

import numpy as np

from perception.shelf.planning.moves import Move, Place, Push
from perception.shelf.planning.room import footprints
from perception.shelf.types import Box, Floats

# How much room is taken to be filled where something was met.
THICK_M = 0.01


class Contacts:
    """Footprints of what was met; a search that forgot them would run into it again and again."""

    def __init__(self) -> None:
        """Begin with none."""
        self._met: list[Floats] = []

    @property
    def footprints(self) -> Floats:
        """Footprints of what was met, shape (M, 4)."""
        return np.array(self._met, dtype=np.float64).reshape(-1, 4)

    def push_stopped(self, box: Box, sign: int) -> None:
        """Something stands beside a box, where it came to rest, on the side of its push.

        Args:
            box: The pushed object, afterwards.
            sign: +1 when it was pushed along x, -1 against it.
        """
        self._met.append(contact_beside(box, sign))

    def blade_stopped(self, box: Box, sign: int) -> None:
        """The blade did not fit in at the side from which it was to push."""
        self._met.append(contact_beside(box, -sign))

    def way_blocked(self, box: Box) -> None:
        """Something stands in front of a box, which did not come out."""
        self._met.append(contact_before(box))

    def place_taken(self, box: Box) -> None:
        """Something stands where a box was to be put down, or in front of it."""
        self._met.append(footprints([box])[0])


def contact_beside(box: Box, sign: int) -> Floats:
    """Return the footprint of something that stands beside a box, shape (4,).

    Args:
        box: The box.
        sign: +1 for the side along x, -1 for the one against it.
    """
    own = footprints([box])[0]
    side_m = own[2] if sign > 0 else own[0]
    low_m, high_m = sorted((side_m, side_m + sign * THICK_M))
    return np.array([low_m, own[1], high_m, own[3]])


def contact_before(box: Box) -> Floats:
    """Return the footprint of something that stands in front of a box, shape (4,)."""
    low_x_m, front_m, high_x_m, _ = footprints([box])[0]
    return np.array([low_x_m, front_m - THICK_M, high_x_m, front_m])


def contact_of(move: Move, box: Box, failure: str) -> Floats:
    """Return the footprint of what an object's move has failed at, shape (4,).

    Args:
        move: The move.
        box: The object.
        failure: Code of its failure, such as `push.blocked`.
    """
    if isinstance(move, Push):
        sign = push_sign(move)
        return contact_beside(box, sign if failure == "push.blocked" else -sign)
    if failure == "suction.no_place":
        return footprints([box.on_floor(move.x_m, move.y_m)])[0]
    return contact_before(box)


def push_sign(move: Move) -> int:
    """Return +1 or -1 for pushes along or against x, 0 for other moves."""
    if isinstance(move, Place):
        return 0
    return 1 if move.shift_m > 0.0 else -1
