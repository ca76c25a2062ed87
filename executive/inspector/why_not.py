"""Answers to `why-not` and `why-halted`: who decided that a node did not run, or ran no more."""

from itertools import pairwise

from executive.engine.ticks import RUNNER, NodeStatus
from executive.inspector.deciding import (
    REACTIVE,
    SELECTORS,
    SEQUENCES,
    deciders,
    deciding_leaves,
)
from executive.inspector.past import PastRun
from executive.inspector.sentences import (
    Answer,
    Sentence,
    by_whom,
    did,
    end_with_cause,
    said,
    shown,
    when,
    why_asked,
)


def why_not(run: PastRun, node: int, tick: int) -> Answer:
    """Return which sibling or guard decided that a node was not asked in a tick."""
    name, names = run.names.short(node), run.names
    if run.index.answers[tick, node]:
        text = f"it did run: {name} {did(run, node, tick)}, at {when(run, tick)}"
        return Answer(text, ("try: why",), ())
    path = run.index.path_to(node)
    asked = [above for above in path if run.index.answers[tick, above]]
    if not asked:
        return Answer(f"{name} was not asked: {_no_tick(run, tick)}", (), ())
    parent = asked[-1]
    child = path[path.index(parent) + 1]
    reason, who = _not_asked(run, parent, child, tick)
    headline = f"{name} was not asked at {when(run, tick)}: {reason}"
    notes = [f"{names.where(parent)}  {names.short(parent)} decided that"]
    if child != node:
        notes.append(f"all of {names.short(child)} was left out, {name} with it")
    way = [
        Sentence(above, tick, why_asked(run, above, below, tick))
        for above, below in pairwise(path[: path.index(parent) + 1])
    ]
    sections = [
        ("what was asked instead, from the root down", (*way, *_instead(run, parent, who, tick)))
    ]
    return Answer(headline, (*notes, *_elsewhere(run, node, tick)), tuple(sections))


def _no_tick(run: PastRun, tick: int) -> str:
    return (
        f"{when(run, tick)} is no tick of the tree, but the record of what the runner stopped "
        f"after the last one, {run.index.last_tick}"
    )


def _not_asked(run: PastRun, parent: int, child: int, tick: int) -> tuple[str, int | None]:
    """Return why a parent that was asked did not ask a child, and which node decided that."""
    index, names = run.index, run.names
    kind, children = index.nodes[parent].kind, index.children[parent]
    life = index.activation(parent, tick)
    end = index.last_end(child, tick)
    done = end is not None and life is not None and end.end >= life.start
    if kind in SEQUENCES or kind in SELECTORS:
        asked = [c for c in children if index.answers[tick, c]]
        if done and end is not None and kind not in REACTIVE and (not asked or child < asked[-1]):
            now = f", {names.short(asked[-1])} has its turn" if asked else ""
            ended = end_with_cause(run, end)
            return f"{ended}, and {kind} does not ask it again (memory){now}", _last(asked)
        return _stopped_before(run, parent, asked, tick), _last(asked)
    if done and end is not None and kind in ("parallel", "run_once"):
        return f"{end_with_cause(run, end)}, and {kind} asks no child that has finished", None
    if kind == "guard":
        asked_conditions = "; ".join(shown(c) for c in run.conditions(parent, tick))
        return asked_conditions or did(run, parent, tick), parent
    if kind == "retry" and done and end is not None:
        return f"retry pauses after a failure: {end_with_cause(run, end)}", parent
    own = said(run, parent, tick)
    return f"{names.short(parent)} answered without it{f': {own}' if own else ''}", parent


def _last(asked: list[int]) -> int | None:
    return asked[-1] if asked else None


def _stopped_before(run: PastRun, parent: int, asked: list[int], tick: int) -> str:
    if not asked:
        return f"{run.names.short(parent)} asked no child in that tick"
    last = asked[-1]
    answer = run.index.answer(last, tick)
    words = {
        NodeStatus.RUNNING: "is still running",
        NodeStatus.SUCCESS: "succeeded, which is enough",
        NodeStatus.FAILURE: "failed, which is enough",
    }[answer]
    if answer is NodeStatus.RUNNING:
        return f"{run.names.short(last)}, before it, {words}"
    leaf, at = deciding_leaves(run.index, last, tick)[-1]
    why = said(run, leaf, at)
    because = f" ({run.names.short(leaf)}: {why})" if why and leaf != last else why and f" ({why})"
    return f"{run.names.short(last)}, before it, {words}{because}"


def _instead(run: PastRun, parent: int, who: int | None, tick: int) -> list[Sentence]:
    below = [Sentence(parent, tick, f"{run.index.nodes[parent].kind} {did(run, parent, tick)}")]
    if who is not None and who != parent:
        below.append(Sentence(who, tick, did(run, who, tick)))
    return below


def _elsewhere(run: PastRun, node: int, tick: int) -> list[str]:
    """Say when the node did run, or that it never did."""
    lives = run.index.activations(node)
    before = [life for life in lives if life.end < tick]
    after = [life for life in lives if life.start > tick]
    parts = [f"it ran last @{before[-1].start}-{before[-1].end}"] if before else []
    parts += [f"{'next' if before else 'first'} @{after[0].start}"] if after else []
    return [", ".join(parts) if parts else "it never ran in this recording"]


def why_halted(run: PastRun, node: int, tick: int | None) -> Answer:
    """Return who halted a node in a tick, by default when it was halted last, and why."""
    name = run.names.short(node)
    halted = run.index.halted_ticks(node)
    if tick is None:
        tick = halted[-1] if halted else run.index.last_tick
    by = run.index.halted_by(node, tick)
    if by is None:
        at = ", ".join(f"@{t}" for t in halted[-10:])
        times = f"it was halted {len(halted)} times, last at {at}" if halted else "it never was"
        return Answer(f"{name} was not halted at {when(run, tick)}", (times,), ())
    life = run.index.activation(node, tick)
    ran_s = run.index.span_s(life) if life else 0.0
    because = _pre_empted(run, node, by, tick)
    headline = f"{name} was halted by {by_whom(run, by)} at {when(run, tick)}: {because}"
    notes = [f"{run.names.where(node)}  it had run for {ran_s:.1f} s"]
    also = [h.node for h in run.index.halts[tick] if h.node != node]
    if also:
        notes.append(f"halted with it: {', '.join(run.names.short(n) for n in also)}")
    return Answer(headline, tuple(notes), _because(run, by, tick))


def _pre_empted(run: PastRun, node: int, by: int, tick: int) -> str:
    if by == RUNNER:
        result = run.recording.result
        reason = result.report.reason if result else ""
        return reason or "the mission ended while it ran"
    kind = run.index.nodes[by].kind
    path = run.index.path_to(node)
    child = path[path.index(by) + 1]
    asked = [c for c in run.index.children[by] if c != child and run.index.answers[tick, c]]
    words = did(run, by, tick)
    if kind in (*SEQUENCES, *SELECTORS) and asked:
        earlier = asked[-1]
        return f"{run.names.short(earlier)}, which comes before it, {did(run, earlier, tick)}"
    if kind == "parallel":
        decided = ", ".join(run.names.short(c) for c, _ in deciders(run.index, by, tick))
        return f"parallel {words} because of {decided}; the rest is stopped"
    return f"{kind} {words}"


def _because(run: PastRun, by: int, tick: int) -> tuple[tuple[str, tuple[Sentence, ...]], ...]:
    if by == RUNNER:
        return ()
    leaves = deciding_leaves(run.index, by, tick)
    path = run.index.path_to(by)
    way = [
        Sentence(above, tick, why_asked(run, above, below, tick)) for above, below in pairwise(path)
    ]
    way.append(Sentence(by, tick, f"{run.index.nodes[by].kind} {did(run, by, tick)}"))
    way += [Sentence(leaf, at, did(run, leaf, at)) for leaf, at in leaves if leaf != by]
    return (("who pre-empted it, from the root down", tuple(way)),)
