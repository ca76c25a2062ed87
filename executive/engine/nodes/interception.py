"""Stands between a node and its parent: what debuggers and injected faults are built on.

A run without an interceptor pays nothing for it: the calls of a tree are put together once,
with or without one.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from py_trees.common import Status

from executive.core.outcome import Outcome
from executive.core.outcome import Status as Answer
from executive.engine.nodes.calls import StopCall, TickCall, TickLog
from executive.engine.ticks import NodeStatus


@dataclass(frozen=True, slots=True, eq=False)
class Junction:
    """One node, seen from its parent.

    Attributes:
        index: Index of the node.
        node: The node itself.
        tick: Ticks it.
        stop: Brings it to an end.
        log: Where answers are noted.
    """

    index: int
    node: Any
    tick: TickCall
    stop: StopCall
    log: TickLog

    def answer(self, outcome: Outcome) -> Status:
        """Answer in the place of the node, which is halted first if it runs."""
        ends = outcome.status is not Answer.RUNNING
        if ends and self.node.status is Status.RUNNING:
            self.stop(Status.INVALID)
        self.node.status = Status[outcome.status.name]
        if hasattr(self.node, "outcome"):
            self.node.outcome = outcome
        self.log.events.append((self.index, NodeStatus[outcome.status.name]))
        status: Status = self.node.status
        return status


Interceptor = Callable[[Junction], TickCall]
"""Returns the call that a parent makes instead of `Junction.tick`."""


def chained(interceptors: tuple[Interceptor, ...]) -> Interceptor | None:
    """Return interceptors as one, the first the outermost; None where there is none."""
    if not interceptors:
        return None

    def intercept(junction: Junction) -> TickCall:
        for one in reversed(interceptors):
            tick = one(junction)
            junction = Junction(junction.index, junction.node, tick, junction.stop, junction.log)
        return junction.tick

    return intercept
