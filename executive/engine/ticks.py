"""What one tick did, as plain values: the runner makes them, recordings store them.

The inspector, the live display and later tools read these and never the tree itself, so a
live run and a recording look the same to them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

from executive.core.outcome import Reason
from executive.core.world import StreamMessage
from executive.engine.blackboard import Write

RUNNER = -1
"""Index that stands for the runner where the index of a node is expected."""


class NodeStatus(StrEnum):
    """Status of any node of the tree after a tick; INVALID means not started, or halted."""

    INVALID = "INVALID"
    RUNNING = "RUNNING"
    SUCCESS = "SUCCESS"
    FAILURE = "FAILURE"


@dataclass(frozen=True, slots=True)
class Halt:
    """A running node was stopped before it finished.

    Attributes:
        node: Index of the node.
        by: Index of the nearest ancestor that went on, or `RUNNER`.
    """

    node: int
    by: int


@dataclass(frozen=True, slots=True)
class NodeOutcome:
    """A leaf finished, or a decorator answered without asking its child.

    Attributes:
        node: Index of the node.
        status: SUCCESS or FAILURE.
        reason: Why it failed, if it said so.
    """

    node: int
    status: NodeStatus
    reason: Reason | None


@dataclass(frozen=True, slots=True)
class NodeFault:
    """A node raised, or the cell, or an observer of the run.

    Attributes:
        path: Path of the node; empty where it was no node.
        node_type: Name of the skill or node class; empty where it was no node.
        message: Type and text of the exception.
        traceback: Where it was raised.
    """

    path: str
    node_type: str
    message: str
    traceback: str


@dataclass(frozen=True, slots=True)
class SlowStep:
    """A step of a skill that took longer than it may.

    Attributes:
        node: Index of the node.
        seconds: How long it took, on the machine's clock [s].
        budget_s: How long it may take [s].
    """

    node: int
    seconds: float
    budget_s: float


@dataclass(frozen=True, slots=True)
class Tick:
    """Everything that one tick changed.

    Attributes:
        number: Counted from 0. The one after the last tick, without visits, holds what the
            runner stopped at the end.
        time_s: When it began, on the cell's clock [s].
        duration_s: How long it took, on the machine's clock [s].
        visited: Indices of the nodes that were ticked, in the order in which they answered.
        changes: Index and new status of every node whose status is not what it was.
        halts: Running nodes that were stopped.
        outcomes: Leaves that finished, and decorators that answered by themselves.
        writes: Blackboard writes, in order; in a recording, values are in their JSON form.
        faults: Exceptions.
        slow: Steps that took longer than they may.
    """

    number: int
    time_s: float
    duration_s: float
    visited: tuple[int, ...] = ()
    changes: tuple[tuple[int, NodeStatus], ...] = ()
    halts: tuple[Halt, ...] = ()
    outcomes: tuple[NodeOutcome, ...] = ()
    writes: tuple[Write, ...] = ()
    faults: tuple[NodeFault, ...] = ()
    slow: tuple[SlowStep, ...] = ()


class RunObserver(Protocol):
    """Told of everything that happens in a run, as it happens."""

    def on_tick(self, tick: Tick) -> None:
        """Take the record of one tick."""
        ...

    def on_streams(self, messages: Sequence[StreamMessage]) -> None:
        """Take what the cell streamed since the last tick."""
        ...
