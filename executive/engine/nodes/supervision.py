"""What the nodes of one tree answer to, and where they report what went wrong."""

from dataclasses import dataclass, field
from typing import Literal

from executive.engine.nodes.claims import Claims

OnError = Literal["end", "fail"]
RAISED = "node.raised"
"""Reason code of a node that raised where a mission goes on after that."""


@dataclass(frozen=True, slots=True)
class LateStep:
    """A step of the leaf at `path` that took `seconds` where `budget_s` were allowed."""

    path: str
    seconds: float
    budget_s: float


@dataclass(frozen=True, slots=True)
class RaisedInNode:
    """What the node at `path` raised without ending the mission."""

    path: str
    cause: Exception


@dataclass(slots=True)
class Supervision:
    """Shared by the nodes of one tree.

    Attributes:
        on_error: Whether a node that raises ends the mission, or fails.
        budget_s: How long a step may take where a leaf does not say so [s]; None for ever.
        claims: Who holds which arm.
    """

    on_error: OnError = "end"
    budget_s: float | None = None
    claims: Claims = field(default_factory=Claims)
    _late: list[LateStep] = field(default_factory=list)
    _raised: list[RaisedInNode] = field(default_factory=list)

    def note_late(self, path: str, seconds: float, budget_s: float) -> None:
        """Take note of a step that took too long."""
        self._late.append(LateStep(path, seconds, budget_s))

    def note_raised(self, path: str, cause: Exception) -> None:
        """Take note of what a node raised that fails instead of ending the mission."""
        self._raised.append(RaisedInNode(path, cause))

    def drain(self) -> tuple[tuple[LateStep, ...], tuple[RaisedInNode, ...]]:
        """Return what has been noted since the last call."""
        if not self._late and not self._raised:
            return (), ()
        noted = tuple(self._late), tuple(self._raised)
        self._late.clear()
        self._raised.clear()
        return noted
