"""Choose what to move next."""

from typing import Annotated

from executive.core.outcome import failure, success
from executive.core.skill import In, Port, Skill, SkillRun
from executive.core.work import Worker
from perception.shelf.beliefs import ShelfBelief
from perception.shelf.interfaces import ShelfReasoning
from perception.shelf.planning.moves import Place, Push


class ChooseMove(Skill):
    """Look ahead over sequences of moves, and choose the one that begins the best.

    SUCCESS: `move` is a push or a change of place of a seen object; `shows` and `expected_moves`
        say what is expected of it and of what comes after.
    FAILURE: `search.stuck` when no object that helps can be moved.
    """

    OUT = {
        "move": Port(Push | Place, "what to move, and where"),
        "shows": Port(float, "probability that the target shows after it"),
        "expected_moves": Port(float, "moves until the target shows, on average"),
    }
    REASONS = frozenset({"search.stuck"})

    def __init__(self, search: ShelfReasoning, worker: Worker) -> None:
        """Bind who plans, and who has the time for it."""
        self._search, self._worker = search, worker

    def run(self, belief: Annotated[ShelfBelief, In("what is known of the shelf")]) -> SkillRun:
        """Plan."""
        plan = yield from self._worker.run(self._search.choose, belief)
        if plan is None:
            return failure("search.stuck", "no object that helps can be moved")
        return success(move=plan.moves[0], shows=plan.shows, expected_moves=plan.expected_moves)
