"""Take a look into what is believed of the shelf."""

from typing import Annotated

from executive.core.outcome import success
from executive.core.skill import In, Port, Skill, SkillRun
from executive.core.work import Worker
from perception.rgbd import RgbdFrame
from perception.shelf.beliefs import ShelfBelief
from perception.shelf.detections import Detections
from perception.shelf.interfaces import ShelfReasoning


class UpdateBelief(Skill):
    """Match what is seen with what was known, and rule out where the target would have shown.

    SUCCESS: `belief` holds all objects seen so far with their best readings, the probability of
        each place of the target, and a picture of both.
    """

    OUT = {"belief": Port(ShelfBelief, "what is known of the shelf after the look")}

    def __init__(self, search: ShelfReasoning, worker: Worker) -> None:
        """Bind who reasons, and who has the time for it."""
        self._search, self._worker = search, worker

    def run(
        self,
        belief: Annotated[ShelfBelief, In("what was known before the look")],
        frame: Annotated[RgbdFrame, In("the look")],
        detections: Annotated[Detections, In("objects in it and what they may be")],
    ) -> SkillRun:
        """Update."""
        belief = yield from self._worker.run(self._search.see, belief, frame, detections)
        return success(belief=belief)
