"""Push an object along the shelf."""

from typing import Annotated

from executive.core.outcome import failure, success
from executive.core.skill import In, Port, SkillRun
from perception.shelf.beliefs import ShelfBelief
from perception.shelf.interfaces import object_of
from perception.shelf.planning.contacts import contact_beside
from perception.shelf.planning.moves import Place, Push
from robots.shelf_tool import PushAlong
from skills.shelf.tool_skill import (
    MOTION_REASONS,
    NOT_SEEN,
    PUSH_REASONS,
    AccountedSkill,
    cuboid,
    failed,
    nothing_met,
    unseen,
)

# A push that stops shorter than asked by less has met what was seen.
SHORT_M = 0.01


class PushObject(AccountedSkill):
    """Push an object with the blade, until it has gone far enough or meets something.

    SUCCESS: the object has moved; `belief` has it where it is by the way that it went, and what it
        has met unseen.
    FAILURE: `move.other` when the move is none for the blade; `object.not_seen`; `push.blocked`
        when something stands beside it, `push.no_room_for_blade` when the blade does not get in,
        `push.nothing_there` when the object is not where it was seen; a motion reason.
    stop(): the arm comes to rest; the object stays where it was pushed to.
    """

    OUT = {"belief": Port(ShelfBelief, "what is known of the shelf after the push")}
    REASONS = MOTION_REASONS | PUSH_REASONS | {NOT_SEEN, "move.other"}

    def run(
        self,
        belief: Annotated[ShelfBelief, In("what is known of the shelf")],
        move: Annotated[Push | Place, In("which object, and how far along the shelf")],
    ) -> SkillRun:
        """Push."""
        if not isinstance(move, Push):
            return failure("move.other", "this move is one for the cup")
        thing = object_of(belief, move.label)
        if thing is None:
            return unseen(move.label, belief)
        result = yield from self._do(PushAlong(cuboid(thing.box), move.shift_m))
        if result.failure is not None:
            return failed(result, move.label)
        sign = 1 if move.shift_m > 0.0 else -1
        box = thing.box.at(thing.box.x_m + sign * result.moved_m, thing.box.y_m)
        met = contact_beside(box, sign)[None] if result.met_m > SHORT_M else nothing_met()
        return success(belief=self._search.moved(belief, move.label, box, met))
