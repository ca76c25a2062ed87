"""Which node is the next to stop at, after a step was asked for."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from executive.engine.nodes.builder import NodeInfo


class Step(StrEnum):
    """How far to go on before the next stop."""

    TICK = "tick"
    INTO = "into"
    OVER = "over"
    OUT = "out"


@dataclass(frozen=True, slots=True)
class Stride:
    """A step that is under way: stops before the first node that is not within `within`.

    Attributes:
        step: What was asked for.
        within: Nodes that are passed.
    """

    step: Step
    within: frozenset[int]

    def ends_before(self, node: int) -> bool:
        """Return whether it ends before this node is ticked."""
        return self.step is not Step.TICK and node not in self.within


def stride(step: Step, nodes: Sequence[NodeInfo], at: int | None) -> Stride:
    """Return the step from a node that is about to be ticked, or has just answered.

    Args:
        step: What is asked for.
        nodes: Node table, parents before children.
        at: Index of the node; None between two ticks, where the root comes next.
    """
    if step in (Step.TICK, Step.INTO) or at is None:
        return Stride(step, frozenset())
    top = at if step is Step.OVER else nodes[at].parent
    if not top:  # over or out of the whole tree
        return Stride(Step.TICK, frozenset())
    return Stride(step, below(nodes, top))


def below(nodes: Sequence[NodeInfo], top: int) -> frozenset[int]:
    """Return a node and everything below it."""
    found = {top}
    for node in nodes[top + 1 :]:
        if node.parent in found:
            found.add(node.index)
    return frozenset(found)
