"""Where in a recording something changed."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

from executive.core.errors import InputError
from executive.core.registry import closest
from executive.engine.recording.messages import RecordedNode
from executive.engine.recording.reader import Recording
from executive.engine.ticks import NodeStatus, Tick


@dataclass(frozen=True, slots=True)
class Change:
    """One node got another status.

    Attributes:
        tick: When.
        time_s: When that tick began, on the cell's clock [s].
        path: Path of the node.
        old: What it was.
        new: What it became.
        reason: Why it failed, or who halted it; empty otherwise.
    """

    tick: int
    time_s: float
    path: str
    old: NodeStatus
    new: NodeStatus
    reason: str


def matching_nodes(nodes: Sequence[RecordedNode], pattern: str | None) -> frozenset[int]:
    """Return the indices of nodes whose path or name matches a glob; all without one.

    Raises:
        InputError: None matches.
    """
    if pattern is None:
        return frozenset(range(len(nodes)))
    found = frozenset(
        index
        for index, node in enumerate(nodes)
        if fnmatchcase(node.path, pattern) or fnmatchcase(node.name, pattern)
    )
    if not found:
        known = sorted({node.name for node in nodes})
        raise InputError(f"--node {pattern}: no node matches; {closest(pattern, known)}")
    return found


def status_changes(recording: Recording, nodes: frozenset[int]) -> Iterator[Change]:
    """Return every change of status of the given nodes, in order."""
    table = recording.header.nodes
    statuses = [NodeStatus.INVALID] * len(table)
    for tick in recording.ticks():
        said = _explanations(tick, table)
        for node, new in tick.changes:
            if node in nodes:
                yield Change(
                    tick.number,
                    tick.time_s,
                    table[node].path,
                    statuses[node],
                    new,
                    said.get(node, ""),
                )
            statuses[node] = new


def _explanations(tick: Tick, nodes: Sequence[RecordedNode]) -> dict[int, str]:
    """Return what the tick says about why nodes became what they are."""
    said = {end.node: str(end.reason) for end in tick.outcomes if end.reason is not None}
    for halt in tick.halts:
        by = nodes[halt.by].path if halt.by >= 0 else "the runner"
        said[halt.node] = f"halted by {by}"
    return said
