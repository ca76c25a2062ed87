"""The two actions of a search: a push along the shelf, and a change of place (thesis, 5.2)."""

from dataclasses import dataclass
from typing import ClassVar, Literal

from perception.shelf.types import Box


@dataclass(frozen=True, slots=True)
class Push:
    """Push an object along the shelf until it has gone that far or touches something.

    Attributes:
        label: Which object.
        shift_m: How far along x; negative against it.
    """

    kind: ClassVar[Literal["push"]] = "push"
    label: str
    shift_m: float


@dataclass(frozen=True, slots=True)
class Place:
    """Take an object out with the suction cup and put it down elsewhere.

    Attributes:
        label: Which object.
        x_m: Where its centre goes, along the shelf.
        y_m: Where its centre goes, into the shelf.
    """

    kind: ClassVar[Literal["place"]] = "place"
    label: str
    x_m: float
    y_m: float


Move = Push | Place


def moved_box(move: Move, box: Box) -> Box:
    """Return where an object would stand after a move."""
    if isinstance(move, Place):
        return box.on_floor(move.x_m, move.y_m)
    return box.at(box.x_m + move.shift_m, box.y_m)


@dataclass(frozen=True, slots=True)
class Plan:
    """A sequence of moves.

    Attributes:
        moves: The moves; only the first is to be made before the next look.
        shows: Probability that the first one shows the target.
        expected_moves: How many moves are expected to be needed.
        finds: Probability that all of them together show it.
    """

    moves: tuple[Move, ...]
    shows: float
    expected_moves: float
    finds: float
