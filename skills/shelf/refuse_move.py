"""Remember a move that did not work."""

from typing import Annotated

from executive.core.outcome import failure, success
from executive.core.skill import In, Port, Skill, SkillRun
from perception.shelf.beliefs import ShelfBelief
from perception.shelf.interfaces import ShelfReasoning
from perception.shelf.planning.moves import Place, Push
from robots.shelf_tool import ShelfTool


class RefuseMove(Skill):
    """Believe that something unseen stands in the way of the move that the tool has just failed at.

    By the tool's reason that is beside the object, in front of it, or where it was to go; an object
    that the tool did not find, or has lost, must be looked for. The next choice is another one.

    SUCCESS: `belief` knows of it.
    FAILURE: `move.fine` when the tool's last action has not failed.
    """

    OUT = {"belief": Port(ShelfBelief, "what is known of the shelf")}
    REASONS = frozenset({"move.fine"})
    CLAIMS = frozenset({"tool"})

    def __init__(self, tool: ShelfTool, search: ShelfReasoning) -> None:
        """Bind the arm, which knows what failed, and who keeps account."""
        self._tool, self._search = tool, search

    def run(
        self,
        belief: Annotated[ShelfBelief, In("what is known of the shelf")],
        move: Annotated[Push | Place, In("the move that has failed")],
    ) -> SkillRun:
        """Remember."""
        yield from ()
        result = self._tool.result()
        if result is None or result.failure is None:
            return failure("move.fine", "the last action of the tool has not failed")
        return success(belief=self._search.refused(belief, move, result.failure.value))
