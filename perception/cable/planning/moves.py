"""What a robot can do to a cable on a table, and the diagram that each move should leave.

Ends: lift one off what it lies on, pull one out from under other strands, or draw it through a
loop of a knot (cage-pinch dilation: the loop is held, the cable slides through a cage). Nothing
else changes the knot of an open cable. Between the ends: untwist a loop (Reidemeister I), pull
two strands apart (II), lay a strand that runs on top elsewhere (passes, with them III), or draw
one out sideways from under others. No move is offered that leaves more crossings.
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import Literal

from perception.cable.planning.open_diagram import OpenDiagram

End = Literal["start", "finish"]
Role = Literal["pinch", "cage"]


class MoveKind(StrEnum):
    """What hands do."""

    LIFT_END = "lift_end"
    PULL_OUT = "pull_out"
    DILATE = "dilate"
    UNTWIST = "untwist"
    PULL_APART = "pull_apart"
    LAY_OVER = "lay_over"
    DRAW_OUT = "draw_out"


@dataclass(frozen=True, slots=True)
class Hold:
    """Where a hand may take the cable.

    Attributes:
        role: Whether the cable is held or slides.
        interval: Arc positions between which it may be taken.
        near: Arc position that would be best if there were room everywhere.
    """

    role: Role
    interval: tuple[float, float]
    near: float


@dataclass(frozen=True, slots=True)
class Move:
    """One move on a diagram.

    Attributes:
        kind: What is done.
        end: Which end is moved; None for none.
        interval: Arc positions between which the cable is moved.
        holds: Where it is held, one a hand.
        passed: Visits that are undone or laid elsewhere.
        below: How many of these run under another strand.
        predicted: The diagram that should be left.
        stays: The edge behind what an end is drawn from, as arc positions; None for no end.
        across: Arc positions of the strands that a run is laid over anew.
    """

    kind: MoveKind
    end: End | None
    interval: tuple[float, float]
    holds: tuple[Hold, ...]
    passed: int
    below: int
    predicted: OpenDiagram
    stays: tuple[float, float] | None = None
    across: tuple[float, ...] = ()
