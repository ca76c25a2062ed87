"""What a run that goes on knows of the run before it."""

from collections.abc import Mapping
from dataclasses import dataclass

from executive.core.outcome import Reason
from executive.engine.checkpoints.messages import CheckpointMessage, Progress
from executive.engine.recording.messages import ResumedFrom
from executive.engine.recording.reader import Recording
from executive.engine.ticks import NodeOutcome, NodeStatus


@dataclass(frozen=True, slots=True)
class Moment:
    """How far a run has come in the middle of a tick.

    Attributes:
        progress: Tick and times.
        events: What nodes have answered in this tick.
        outcomes: How leaves, and nodes that decide by themselves, have ended in it.
    """

    progress: Progress
    events: tuple[tuple[int, NodeStatus], ...]
    outcomes: tuple[NodeOutcome, ...]


@dataclass(frozen=True, slots=True)
class Past:
    """What a runner begins with, so that its ticks follow the earlier ones.

    Attributes:
        progress: How far the run had come.
        statuses: Of all nodes after the last whole tick.
        events: What nodes had answered in the tick that was under way.
        told: Tick, status and reason of the last end of the nodes that ended in the last tick.
        reasons: Why nodes failed last, by index.
    """

    progress: Progress
    statuses: tuple[NodeStatus, ...]
    events: tuple[tuple[int, NodeStatus], ...]
    told: Mapping[int, tuple[int, NodeStatus, Reason | None]]
    reasons: Mapping[int, Reason]


@dataclass(frozen=True, slots=True, eq=False)
class Resumption:
    """A checkpoint that a tree and a cell have been put back to.

    Attributes:
        origin: Where it is, for the header of the new recording.
        earlier: The recording that holds it.
        past: What the runner begins with.
    """

    origin: ResumedFrom
    earlier: Recording
    past: Past


def past_of(recording: Recording, message: CheckpointMessage) -> Past:
    """Return what a run goes on with from a checkpoint of a recording."""
    events = tuple(
        event for event in message.events if not _is_redone(event[0], recording, message)
    )
    last = message.progress.tick - 1
    if last < 0:
        untouched = (NodeStatus.INVALID,) * len(message.statuses)
        return Past(message.progress, untouched, events, {}, {})
    statuses, visited = recording.statuses(last), set(recording.tick(last).visited)
    told = {
        node: (last, end.status, end.reason)
        for node, end in recording.outcomes(last).items()
        if node in visited and statuses[node] is end.status
    }
    return Past(message.progress, statuses, events, told, recording.reasons(last))


def _is_redone(node: int, recording: Recording, message: CheckpointMessage) -> bool:
    """Return whether a node that has answered is asked again when the tick is taken up.

    Reactive parents of the checkpoint begin with their first child, and a parallel ticks what
    runs in it.
    """
    nodes = recording.header.nodes
    above = {message.node}
    place = nodes[message.node].parent
    while place is not None:
        above.add(place)
        place = nodes[place].parent
    branch, parent = node, nodes[node].parent
    while parent is not None and parent not in above:
        branch, parent = parent, nodes[parent].parent
    if parent is None:
        return False
    runs = message.statuses[branch] is NodeStatus.RUNNING
    return nodes[parent].kind.startswith("reactive_") or (nodes[parent].kind == "parallel" and runs)
