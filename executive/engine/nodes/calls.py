"""What a tick is made of: the calls that tick and stop nodes, and the log of what they do."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.engine.ticks import NodeStatus

Event = tuple[int, NodeStatus]
"""A node answered, or, with INVALID, was stopped before it had finished or told to forget."""

TickCall = Callable[[], Status]
"""Ticks a node and everything below it; returns its answer."""

StopCall = Callable[[Status], None]
"""Brings a node to an end with a status, as `Behaviour.stop` does."""


@dataclass(slots=True, eq=False)
class TickLog:
    """What happens in a tick, in order.

    Attributes:
        events: Answers and stops.
        broken: Nodes that answered with no status (trap e13).
        unseen: Nodes whose status may have changed without an event: those below a node that
            only py_trees itself can tick or stop.
        raised: Node whose method raised; None where none did.
        terminating: Whether that was in `terminate`.
    """

    events: list[Event] = field(default_factory=list)
    broken: list[Behaviour] = field(default_factory=list)
    unseen: set[int] = field(default_factory=set)
    raised: Behaviour | None = None
    terminating: bool = False

    def clear(self) -> None:
        """Begin a new tick."""
        self.events.clear()
        self.broken.clear()
        self.unseen.clear()
        self.raised, self.terminating = None, False

    def note_raised(self, node: Behaviour, *, terminating: bool) -> None:
        """Remember who raised; the first to say so is the innermost."""
        if self.raised is None:
            self.raised, self.terminating = node, terminating


@dataclass(frozen=True, slots=True, eq=False)
class Spot:
    """One node, and what the calls of its kind need.

    Attributes:
        node: The node; `Any`, since kinds have attributes of their own.
        index: Its index.
        log: Where its answers go.
        stop: Its `stop`.
        ticks: Ticks of its children.
        stops: Stops of its children.
    """

    node: Any
    index: int
    log: TickLog
    stop: StopCall
    ticks: Sequence[TickCall]
    stops: Sequence[StopCall]

    @property
    def children(self) -> tuple[tuple[Any, StopCall], ...]:
        """Children with their stops."""
        return tuple(zip(self.node.children, self.stops, strict=True))

    def defines(self, method: str) -> bool:
        """Return whether the node does something where py_trees calls a method of it."""
        own = method in vars(self.node)
        return own or getattr(type(self.node), method) is not getattr(Behaviour, method)

    def answers(self) -> tuple[Event, Event, Event]:
        """Return what it may answer: running, success, failure."""
        return (
            (self.index, NodeStatus.RUNNING),
            (self.index, NodeStatus.SUCCESS),
            (self.index, NodeStatus.FAILURE),
        )
