"""Why a mission ended as it did: the leaves that decided, and the way up from each."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from executive.core.outcome import Reason
from executive.engine.nodes.builder import NodeInfo
from executive.engine.ticks import NodeStatus


@dataclass(frozen=True, slots=True)
class Cause:
    """One leaf that decided the answer of the root.

    Attributes:
        path: Path of the leaf.
        status: What it answered.
        reason: What it said, if it failed and said why.
    """

    path: str
    status: NodeStatus
    reason: Reason | None

    def __str__(self) -> str:
        """Return `path: code: text`, or the status where there is no reason."""
        return f"{self.path}: {self.reason or self.status.lower()}"


def deciding_leaves(
    nodes: Sequence[NodeInfo],
    answers: Mapping[int, NodeStatus],
    reasons: Mapping[int, Reason],
) -> tuple[Cause, ...]:
    """Follow the answer of the root down to the leaves that decided it.

    A node's answer comes from those of its children that gave the same one; where none did
    (an inverter, a decorator that forces an answer) it comes from the child that was asked
    last.

    Args:
        nodes: Node table, parents before children.
        answers: What each node that was visited answered, by index, in order.
        reasons: Latest reason of each leaf, by index.

    Returns:
        The deciding leaves in the order in which they answered.
    """
    children: dict[int, list[int]] = {}
    for node in answers:
        parent = nodes[node].parent
        if parent is not None:
            children.setdefault(parent, []).append(node)
    leaves, to_follow = set(), [next(node for node in answers if nodes[node].parent is None)]
    while to_follow:
        node = to_follow.pop()
        asked = children.get(node, [])
        if not asked:
            leaves.add(node)
        same = [child for child in asked if answers[child] is answers[node]]
        to_follow.extend(same or asked[-1:])
    return tuple(
        Cause(nodes[node].path, answers[node], reasons.get(node))
        for node in answers
        if node in leaves
    )
