"""Begin to search a shelf."""

from typing import Annotated

from executive.core.outcome import success
from executive.core.skill import In, Port, Skill, SkillRun
from executive.core.work import Worker
from perception.shelf.beliefs import ShelfBelief
from perception.shelf.interfaces import ShelfReasoning


class BeginSearch(Skill):
    """Believe what is known before the first look: the target may be anywhere on the shelf.

    SUCCESS: `belief` is that of a shelf of which nothing has been seen.
    """

    OUT = {"belief": Port(ShelfBelief, "what is known of the shelf")}

    def __init__(self, search: ShelfReasoning, worker: Worker) -> None:
        """Bind who reasons, and who has the time for it."""
        self._search, self._worker = search, worker

    def run(self, target: Annotated[str, In("name of the product to search for")]) -> SkillRun:
        """Lay out where it may stand."""
        belief = yield from self._worker.run(self._search.begin, target)
        return success(belief=belief)
