"""Answers to `why`: why a node ran, went on, succeeded or failed in a tick."""

from itertools import pairwise

from executive.engine.ticks import NodeStatus
from executive.inspector.deciding import Decision, chain, deciders
from executive.inspector.past import PastRun
from executive.inspector.sentences import (
    Answer,
    Sentence,
    did,
    end_with_cause,
    when,
    why_asked,
)
from executive.inspector.why_not import why_halted, why_not


def why(run: PastRun, node: int, tick: int | None) -> Answer:
    """Return why a node did what it did in a tick, by default in the one of its last end.

    Where it was not asked in that tick, the answer is that of `why_not`; where it was halted
    in it, that of `why_halted`.
    """
    if tick is None:
        tick = _last_end(run, node)
    if run.index.halted_by(node, tick) is not None:
        return why_halted(run, node, tick)
    if not run.index.answers[tick, node]:
        return why_not(run, node, tick)
    name = run.names.short(node)
    headline = f"{name} {did(run, node, tick)}, at {when(run, tick)}"
    sections = [("why it was asked, from the root down", tuple(_way_down(run, node, tick)))]
    below = chain(run.index, node, tick)[1:]
    if below:
        title = "why it answered so, down to the leaf that decided"
        sections.append((title, tuple(_decided(run, [(node, tick), *below]))))
    return Answer(headline, tuple(_life(run, node, tick)), tuple(sections))


def why_ended(run: PastRun) -> Answer:
    """Return why the mission ended as it did."""
    report = run.recording.result.report if run.recording.result else None
    tick = run.index.last_tick
    if report is None:
        ended = f"no result: the run was killed, or still goes on, after {when(run, tick)}"
    else:
        because = f": {report.reason}" if report.reason else ""
        ended = f"{run.recording.header.mission} ended in {report.outcome}{because}"
    below = chain(run.index, 0, tick)
    title = f"from the root down, at {when(run, tick)}"
    return Answer(ended, (), ((title, tuple(_decided(run, below))),))


def _last_end(run: PastRun, node: int) -> int:
    lives = run.index.activations(node)
    if not lives:
        return run.index.last_tick
    return lives[-1].end if lives[-1].status is not NodeStatus.RUNNING else run.index.last_tick


def _life(run: PastRun, node: int, tick: int) -> list[str]:
    life = run.index.activation(node, tick)
    recorded = run.index.nodes[node]
    what = recorded.kind if recorded.type in (recorded.kind, "") else f"skill {recorded.type}"
    if life is None:
        return [f"{run.names.where(node)}  {what}"]
    ran_s = float(run.index.times_s[tick] - run.index.times_s[life.start])
    started = (
        "started then" if life.start == tick else f"started @{life.start}, {ran_s:.1f} s before"
    )
    count = sum(other.start <= tick for other in run.index.activations(node))
    return [f"{run.names.where(node)}  {what}, {started}; activation {count} of the run"]


def _way_down(run: PastRun, node: int, tick: int) -> list[Sentence]:
    """Return why each parent on the way to a node asked the next one."""
    path = run.index.path_to(node)
    return [
        Sentence(parent, tick, why_asked(run, parent, child, tick))
        for parent, child in pairwise(path)
    ] or [Sentence(node, tick, "the root, asked in every tick")]


def _decided(run: PastRun, way: list[Decision]) -> list[Sentence]:
    """Return what each node of a way down answered, and which children had a say."""
    sentences = []
    for node, tick in way:
        below = deciders(run.index, node, tick)
        text = did(run, node, tick) if not below else _outcome(run, node, tick, below)
        sentences.append(Sentence(node, tick, text))
    return sentences


def _outcome(run: PastRun, node: int, tick: int, below: list[Decision]) -> str:
    kind, words = run.index.nodes[node].kind, did(run, node, tick)
    children = len(run.index.children[node])
    place = run.index.children[node].index(below[-1][0]) + 1
    if len(below) > 1:
        ends = [run.index.activation(child, at) for child, at in below]
        shown = [end_with_cause(run, end) for end in ends if end is not None]
        return f"{kind} {words}: all of {', '.join(shown)}"
    if children == 1:
        return f"{kind} {words}{_count(run, node, tick)}"
    return f"{kind} {words} with child {place} of {children}, {run.names.short(below[0][0])}"


def _count(run: PastRun, node: int, tick: int) -> str:
    kind = run.index.nodes[node].kind
    if kind not in ("retry", "repeat", "for_each"):
        return ""
    (child,) = run.index.children[node]
    return f" ({why_asked(run, node, child, tick).removeprefix(f'{kind}: ')})"
