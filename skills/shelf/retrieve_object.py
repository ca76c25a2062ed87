"""Take an object out of the shelf and hand it over."""

from typing import Annotated

from executive.core.outcome import success
from executive.core.skill import In, Port, SkillRun
from perception.shelf.beliefs import ShelfBelief
from perception.shelf.interfaces import object_of
from robots.shelf_tool import TakeOut
from skills.shelf.tool_skill import (
    CUP_REASONS,
    MOTION_REASONS,
    NOT_SEEN,
    AccountedSkill,
    cuboid,
    failed,
    unseen,
)


class RetrieveObject(AccountedSkill):
    """Suck an object on, take it out of the shelf and bring it to where things are handed over.

    SUCCESS: the object is handed over; `belief` has it no more.
    FAILURE: `object.not_seen`; `suction.no_cup`; `suction.obstructed` when something stands in
        front, `suction.missed` when the cup has not taken hold, `suction.lost` when the object fell
        off on the way; a motion reason.
    stop(): the arm comes to rest; a held object stays held.
    """

    OUT = {"belief": Port(ShelfBelief, "what is known of the shelf without the object")}
    REASONS = MOTION_REASONS | CUP_REASONS | {NOT_SEEN}

    def run(
        self,
        belief: Annotated[ShelfBelief, In("what is known of the shelf")],
        label: Annotated[str, In("name of the object")],
    ) -> SkillRun:
        """Take out."""
        thing = object_of(belief, label)
        if thing is None:
            return unseen(label, belief)
        result = yield from self._do(TakeOut(cuboid(thing.box)))
        if result.failure is not None:
            return failed(result, label)
        return success(belief=self._search.removed(belief, label))
