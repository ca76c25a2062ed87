"""What an injected fault led to, from the recording of the run alone."""

from dataclasses import dataclass
from typing import Literal

from executive.engine.faults.grammar import KEY_KINDS, Kind
from executive.engine.faults.variants import Seen
from executive.engine.ticks import RUNNER, NodeStatus
from executive.inspector.index import RunIndex
from executive.inspector.past import PastRun

Answer = Literal["", "recovered", "still trying"]


@dataclass(frozen=True, slots=True)
class Effect:
    """What one fault led to.

    Attributes:
        happened: Whether it happened at all.
        to_the_end: Whether the node that hung did so until the run was ended.
        answered_by: Short name of the node that answered for it: the first ancestor that did
            not fail with it. Empty where none did, and for keys, which fail nobody by
            themselves.
        answer: What came of that: `recovered` when that node succeeded in the end, `still
            trying` when the run ended before.
        left_running: Leaves that ran when the recording ended.
    """

    happened: bool
    to_the_end: bool
    answered_by: str
    answer: Answer
    left_running: tuple[str, ...]


def seen_in(index: RunIndex) -> Seen:
    """Return how often skills have started and keys were written in a run."""
    return Seen(
        {
            node.path: len(index.activations(number))
            for number, node in enumerate(index.nodes)
            if node.kind == "skill"
        },
        {key: sum(1 for place in places if place.writer) for key, places in index.writes.items()},
    )


def effect_of(run: PastRun, kind: Kind) -> Effect:
    """Return what the one fault of a run led to."""
    index, result = run.index, run.recording.result
    report = result.injected[0] if result is not None and result.injected else None
    running = left_running(index)
    if report is None or report.first_tick is None:
        return Effect(
            happened=False, to_the_end=False, answered_by="", answer="", left_running=running
        )
    node, tick = index.indices.get(report.places[0]), report.first_tick
    if node is None or kind in KEY_KINDS:
        return Effect(True, False, "", "", running)
    by, answer, to_the_end = _answered(run, node, tick)
    return Effect(True, to_the_end, by, answer, running)


def left_running(index: RunIndex) -> tuple[str, ...]:
    """Return the leaves that ran when the recording ended."""
    last = len(index) - 1
    return tuple(
        node.path
        for number, node in enumerate(index.nodes)
        if not index.children[number] and index.status(number, last) is NodeStatus.RUNNING
    )


def _answered(run: PastRun, node: int, tick: int) -> tuple[str, Answer, bool]:
    index = run.index
    life = index.activation(node, tick)
    if life is None:
        return "", "", False
    end = life.end
    if life.status in (NodeStatus.INVALID, NodeStatus.RUNNING):
        halter = index.halted_by(node, end)
        if halter is None or halter == RUNNER:
            return "", "", True
        above: int | None = halter
    else:
        above = index.nodes[node].parent
    while above is not None:
        life = index.activation(above, end)
        if life is None:
            return "", "", False
        if life.status is NodeStatus.SUCCESS:
            return run.names.short(above), "recovered", False
        if life.end > end and life.status is not NodeStatus.FAILURE:
            return run.names.short(above), "still trying", False
        end, above = life.end, index.nodes[above].parent
    return "", "", False
