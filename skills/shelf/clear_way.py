"""Choose what to move out of the way of an object."""

from typing import Annotated

from executive.core.outcome import failure, success
from executive.core.skill import In, Port, Skill, SkillRun
from executive.core.work import Worker
from perception.shelf.beliefs import ShelfBelief
from perception.shelf.interfaces import ShelfReasoning, object_of
from perception.shelf.planning.moves import Place, Push
from perception.shelf.planning.room import WIDER_M
from skills.shelf.tool_skill import NOT_SEEN, unseen


class ClearWay(Skill):
    """Choose a move that leaves less in front of an object that is to come out.

    SUCCESS: `move` is such a move.
    FAILURE: `way.none` when nothing stands there, or nothing of it can be moved;
        `object.not_seen` when the object has not been seen.
    """

    OUT = {"move": Port(Push | Place, "what to move, and where")}
    REASONS = frozenset({"way.none", NOT_SEEN})

    def __init__(self, search: ShelfReasoning, worker: Worker) -> None:
        """Bind who plans, and who has the time for it."""
        self._search, self._worker = search, worker

    def run(
        self,
        belief: Annotated[ShelfBelief, In("what is known of the shelf")],
        label: Annotated[str, In("name of the object that is to come out")],
        wider_m: Annotated[
            float,
            In("how much wider its way is taken to be where nothing seems to stand in it", "m"),
        ] = WIDER_M,
    ) -> SkillRun:
        """Plan."""
        if object_of(belief, label) is None:
            return unseen(label, belief)
        move = yield from self._worker.run(self._search.clear_way, belief, label, wider_m)
        if move is None:
            return failure("way.none", f"nothing can be moved from before {label}", label=label)
        return success(move=move)
