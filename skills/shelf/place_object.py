"""Take an object out with the suction cup and put it down elsewhere."""

from typing import Annotated

from executive.core.outcome import failure, success
from executive.core.skill import In, Port, SkillRun
from perception.shelf.beliefs import ShelfBelief
from perception.shelf.interfaces import object_of
from perception.shelf.planning.moves import Place, Push
from robots.shelf_tool import PutElsewhere, ToolFailure
from skills.shelf.tool_skill import (
    CUP_REASONS,
    MOTION_REASONS,
    NOT_SEEN,
    AccountedSkill,
    cuboid,
    failed,
    nothing_met,
    unseen,
)


class PlaceObject(AccountedSkill):
    """Suck an object on, take it out straight, and put it down elsewhere on the shelf.

    SUCCESS: the object stands at its new place; `belief` has it there.
    FAILURE: `move.other` when the move is none for the cup; `object.not_seen`; `suction.no_cup`;
        `suction.obstructed` when something stands in front, `suction.missed` when the cup has not
        taken hold, `suction.no_place` when the place is taken, `suction.lost` when the object fell
        off on the way; a motion reason.
    stop(): the arm comes to rest; a held object stays held.
    """

    OUT = {"belief": Port(ShelfBelief, "what is known of the shelf after the move")}
    REASONS = MOTION_REASONS | CUP_REASONS | {NOT_SEEN, "move.other", ToolFailure.NO_PLACE.value}

    def run(
        self,
        belief: Annotated[ShelfBelief, In("what is known of the shelf")],
        move: Annotated[Push | Place, In("which object, and where it goes")],
    ) -> SkillRun:
        """Take out, put down."""
        if not isinstance(move, Place):
            return failure("move.other", "this move is one for the blade")
        thing = object_of(belief, move.label)
        if thing is None:
            return unseen(move.label, belief)
        result = yield from self._do(PutElsewhere(cuboid(thing.box), move.x_m, move.y_m))
        if result.failure is not None:
            return failed(result, move.label)
        box = thing.box.on_floor(move.x_m, move.y_m)
        return success(belief=self._search.moved(belief, move.label, box, nothing_met()))
