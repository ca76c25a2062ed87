"""What skills that use the tool at a shelf have in common."""

from collections.abc import Generator

import numpy as np

from executive.core.outcome import Outcome, failure
from executive.core.skill import Skill
from perception.shelf.beliefs import ShelfBelief
from perception.shelf.interfaces import ShelfReasoning
from perception.shelf.types import Box, Floats
from robots.shelf_tool import Cuboid, ShelfTool, ToolAction, ToolFailure, ToolResult

NOT_SEEN = "object.not_seen"
MOTION_REASONS = frozenset(
    {ToolFailure.UNREACHABLE.value, ToolFailure.COLLISION.value, ToolFailure.NO_PATH.value}
)
PUSH_REASONS = frozenset(
    {ToolFailure.NO_BLADE_ROOM.value, ToolFailure.BLOCKED.value, ToolFailure.NOTHING_THERE.value}
)
CUP_REASONS = frozenset(
    {
        ToolFailure.NO_CUP.value,
        ToolFailure.OBSTRUCTED.value,
        ToolFailure.MISSED.value,
        ToolFailure.LOST.value,
    }
)


class ToolSkill(Skill):
    """Base of skills that use the tool.

    A pause holds the motion on its path; `stop()` brings the arm to rest, the cup keeps hold.
    """

    REASONS = MOTION_REASONS
    ACTS = True
    CLAIMS = frozenset({"tool"})

    def __init__(self, tool: ShelfTool) -> None:
        """Bind the tool."""
        self._tool = tool

    def stop(self) -> None:
        """Bring the arm to rest."""
        self._tool.stop()

    def on_pause(self) -> None:
        """Hold the motion on its path."""
        self._tool.hold()

    def on_resume(self) -> None:
        """Take the motion up again."""
        self._tool.go_on()

    def resting(self) -> bool:
        """Return whether nothing moves."""
        return self._tool.resting()

    def _do(self, action: ToolAction) -> Generator[None, None, ToolResult]:
        """Carry an action out and wait for its result."""
        # A skill that was halted for this one may have left the arm on its way to rest.
        while not self._tool.resting():
            yield
        self._tool.start(action)
        while (result := self._tool.result()) is None:
            yield
        return result


class AccountedSkill(ToolSkill):
    """Base of skills after which something stands elsewhere than before."""

    def __init__(self, tool: ShelfTool, search: ShelfReasoning) -> None:
        """Bind the arm, and who keeps account."""
        super().__init__(tool)
        self._search = search


def failed(result: ToolResult, label: str) -> Outcome:
    """Return the failure of an action on an object."""
    assert result.failure is not None
    return failure(result.failure.value, f"{label}: {result.text}", label=label)


def unseen(label: str, belief: ShelfBelief) -> Outcome:
    """Return the failure to act on an object that nobody has seen."""
    known = ", ".join(one.label for one in belief.objects) or "none"
    return failure(NOT_SEEN, f"{label!r} is not among what has been seen: {known}", label=label)


def cuboid(box: Box) -> Cuboid:
    """Return a box as the tool takes it."""
    return Cuboid(box.x_m, box.y_m, box.size_m, box.bottom_m)


def nothing_met() -> Floats:
    """Return no footprints."""
    return np.zeros((0, 4))
