"""What skills ask of the perception and planning of a shelf search; numpy only."""

from typing import Protocol, runtime_checkable

from perception.rgbd import RgbdFrame
from perception.shelf.beliefs import SeenObject, ShelfBelief
from perception.shelf.detections import Detections
from perception.shelf.planning.moves import Move, Plan
from perception.shelf.planning.room import WIDER_M
from perception.shelf.types import Box, Floats


@runtime_checkable
class ShelfReasoning(Protocol):
    """Turns looks into beliefs, and beliefs into moves. It has no memory of its own."""

    def begin(self, target: str) -> ShelfBelief:
        """Return what is believed before the first look.

        Raises:
            InputError: The stock has no such product, or the affinities do not know it.
        """
        ...

    def refine(self, detections: Detections) -> Detections:
        """Sharpen unsure readings by what stands beside them."""
        ...

    def see(self, belief: ShelfBelief, frame: RgbdFrame, detections: Detections) -> ShelfBelief:
        """Take a look in."""
        ...

    def choose(self, belief: ShelfBelief) -> Plan | None:
        """Return the moves that are expected to find the target soonest; None when none helps."""
        ...

    def clear_way(self, belief: ShelfBelief, label: str, wider_m: float = WIDER_M) -> Move | None:
        """Return a move that helps to take a seen object out; None when its way is free or stays.

        Args:
            belief: What is believed.
            label: The object.
            wider_m: How much wider the way is taken to be where nothing seems to stand in it.

        Raises:
            InputError: No such object has been seen.
        """
        ...

    def restore(self, belief: ShelfBelief) -> Move | None:
        """Return a move that brings an object back to where it was first seen; None at the end."""
        ...

    def moved(self, belief: ShelfBelief, label: str, box: Box, met: Floats) -> ShelfBelief:
        """Take in that an object was moved.

        Args:
            belief: What is believed.
            label: The object.
            box: Where it stands now, as far as the tool can tell.
            met: Footprints of what the tool or the object has met and nobody has seen, (M, 4).
        """
        ...

    def refused(self, belief: ShelfBelief, move: Move, failure: str) -> ShelfBelief:
        """Take in that a move has failed.

        Args:
            belief: What is believed.
            move: The move.
            failure: Code of its failure, such as `push.blocked`.
        """
        ...

    def removed(self, belief: ShelfBelief, label: str) -> ShelfBelief:
        """Take in that an object was taken out of the shelf."""
        ...


def object_of(belief: ShelfBelief, label: str) -> SeenObject | None:
    """Return a seen object by its name."""
    return next((one for one in belief.objects if one.label == label), None)
