"""Choose what to bring back to where it stood."""

from typing import Annotated

from executive.core.outcome import failure, success
from executive.core.skill import In, Port, Skill, SkillRun
from perception.shelf.beliefs import ShelfBelief
from perception.shelf.interfaces import ShelfReasoning
from perception.shelf.planning.moves import Place, Push


class RestoreOrder(Skill):
    """Choose a move that brings an object back to where it was first seen.

    SUCCESS: `move` is such a move.
    FAILURE: `order.restored` when nothing that can go back is away from its place.
    """

    OUT = {"move": Port(Push | Place, "what to move, and where")}
    REASONS = frozenset({"order.restored"})

    def __init__(self, search: ShelfReasoning) -> None:
        """Bind who plans."""
        self._search = search

    def run(self, belief: Annotated[ShelfBelief, In("what is known of the shelf")]) -> SkillRun:
        """Plan."""
        yield from ()
        move = self._search.restore(belief)
        if move is None:
            return failure("order.restored", "nothing that can go back is away from its place")
        return success(move=move)
