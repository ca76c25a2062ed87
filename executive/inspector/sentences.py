"""What one node did in one tick and why its parent asked it, in plain sentences."""

from collections.abc import Sequence
from dataclasses import dataclass

from executive.engine.ticks import RUNNER, NodeStatus
from executive.inspector.brief import brief
from executive.inspector.deciding import (
    REACTIVE,
    SELECTORS,
    SEQUENCES,
    deciding_leaves,
    earlier_ends,
)
from executive.inspector.index import FAILURE, Activation
from executive.inspector.past import Condition, PastRun

_ENDED = {
    NodeStatus.SUCCESS: "succeeded",
    NodeStatus.FAILURE: "failed",
    NodeStatus.INVALID: "was halted",
    NodeStatus.RUNNING: "was running",
}
_MANY = 6


@dataclass(frozen=True, slots=True)
class Sentence:
    """One line of an answer.

    Attributes:
        node: Index of the node that it is about, None for the runner.
        tick: Of when it speaks.
        text: What it says, without the name of the node.
    """

    node: int | None
    tick: int
    text: str


@dataclass(frozen=True, slots=True)
class Answer:
    """The answer to one question.

    Attributes:
        headline: The answer in one line.
        notes: What belongs right below it.
        sections: Titles, each with its sentences.
    """

    headline: str
    notes: tuple[str, ...]
    sections: tuple[tuple[str, tuple[Sentence, ...]], ...]


def when(run: PastRun, tick: int) -> str:
    """Return `tick 41 (4.1 s)`."""
    return f"tick {tick} ({run.index.times_s[tick]:.1f} s)"


def did(run: PastRun, node: int, tick: int) -> str:
    """Return what a node answered in a tick, with its reason or the conditions that decided."""
    words = _ENDED[run.index.answer(node, tick)]
    why = said(run, node, tick)
    return f"{words}: {why}" if why else words


def said(run: PastRun, node: int, tick: int) -> str:
    """Return what a node that decided itself said about it; empty where it said nothing."""
    asked = [shown(condition) for condition in run.conditions(node, tick)]
    reason = None
    if run.index.answers[tick, node] == FAILURE:
        reason = run.index.reason(node, tick)
    own = reason is not None and not (asked and reason.code == "condition.false")
    return "; ".join([*([str(reason)] if own else []), *asked])


def shown(condition: Condition) -> str:
    """Return a condition with its value: `if x > 1 was false; x is 0 (look wrote it at @3)`."""
    keyword = "" if condition.keyword == "when" else f"{condition.keyword} "
    value = {True: "was true", False: "was false", None: "cannot be told"}[condition.value]
    terms = f"; {', '.join(condition.terms)}" if condition.terms else ""
    return f"{keyword}{condition.text} {value}{terms}"


def end_with_cause(run: PastRun, end: Activation) -> str:
    """Return `expose failed @26 (leaves_view: ...)`: how a node ended, and who decided that."""
    name = run.names.short(end.node)
    text = f"{name} {_ENDED[end.status]} @{end.end}"
    if end.status is NodeStatus.SUCCESS:
        return f"{text}{_left_out(run, end)}"
    if end.status is not NodeStatus.FAILURE:
        return text
    leaf, tick = deciding_leaves(run.index, end.node, end.end)[-1]
    why = said(run, leaf, tick)
    who = "" if leaf == end.node else run.names.short(leaf)
    because = ": ".join(part for part in (who, why) if part)
    return f"{text} ({because})" if because else text


def _left_out(run: PastRun, end: Activation) -> str:
    """Return ` without look (unless ... was true; ...)` for a guard that decided by itself."""
    if run.index.nodes[end.node].kind != "guard":
        return ""
    (child,) = run.index.children[end.node]
    if any(end.start <= life.start <= end.end for life in run.index.activations(child)):
        return ""
    asked = "; ".join(shown(condition) for condition in run.conditions(end.node, end.end))
    return f" without {run.names.short(child)}{f' ({asked})' if asked else ''}"


def why_asked(run: PastRun, parent: int, child: int, tick: int) -> str:
    """Return why a parent asked a child in a tick."""
    kind = run.index.nodes[parent].kind
    if kind in SEQUENCES or kind in SELECTORS:
        return _in_order(run, parent, child, tick)
    if kind == "parallel":
        return f"parallel: {_place(run, parent, child)}, not finished yet; all run side by side"
    if kind in ("retry", "repeat", "for_each"):
        return _rounds(run, parent, child, tick)
    if kind == "guard":
        asked = [shown(condition) for condition in run.conditions(parent, tick)]
        return f"guard: {'; '.join(asked) or 'its conditions were asked when it started'}"
    since = run.index.activation(parent, tick)
    started = f", since @{since.start}" if since and since.start < tick else ""
    if len(run.index.children[parent]) > 1:
        return f"{kind}: {_place(run, parent, child)}, {_resumed(run, child, tick, kind)}"
    return f"{kind}{_parameters(run, parent)}: passes every tick on to its child{started}"


def _in_order(run: PastRun, parent: int, child: int, tick: int) -> str:
    kind = run.index.nodes[parent].kind
    start = f"{kind}: {_place(run, parent, child)}, {_resumed(run, child, tick, kind)}"
    earlier = earlier_ends(run.index, parent, child, tick)
    if not earlier:
        return start
    again = kind not in REACTIVE and min(tick, _started(run, child, tick)) < tick
    memory = "; not asked again (memory)" if again else ""
    if kind in SELECTORS:
        return f"{start}; earlier ones failed: {_some(run, earlier)}{memory}"
    ends = ", ".join(f"{run.names.short(e.node)} @{e.end}" for e in earlier[-_MANY:])
    more = f"{len(earlier) - _MANY} others, " if len(earlier) > _MANY else ""
    return f"{start}; earlier ones succeeded: {more}{ends}{memory}"


def _some(run: PastRun, ends: Sequence[Activation]) -> str:
    texts = [end_with_cause(run, end) for end in ends[-_MANY:]]
    more = [f"{len(ends) - _MANY} others"] if len(ends) > _MANY else []
    return ", ".join([*more, *texts])


def _started(run: PastRun, node: int, tick: int) -> int:
    life = run.index.activation(node, tick)
    return life.start if life else tick


def _resumed(run: PastRun, child: int, tick: int, kind: str) -> str:
    since = _started(run, child, tick)
    if since == tick:
        return "started now"
    return f"{'goes on' if kind in REACTIVE else 'resumed'} since @{since}"


def _place(run: PastRun, parent: int, child: int) -> str:
    children = run.index.children[parent]
    return f"child {children.index(child) + 1} of {len(children)}"


def rounds_until(run: PastRun, parent: int, child: int, tick: int) -> list[Activation]:
    """Return the lives of a decorator's child in the decorator's present life, up to a tick."""
    since = _started(run, parent, tick)
    return [a for a in run.index.activations(child) if since <= a.start <= tick]


def _rounds(run: PastRun, parent: int, child: int, tick: int) -> str:
    kind = run.index.nodes[parent].kind
    rounds = rounds_until(run, parent, child, tick)
    word = {"retry": "attempt", "repeat": "round", "for_each": "item"}[kind]
    total = run.times(parent)
    text = f"{kind}: {word} {len(rounds)}{f' of {total}' if total else ''}"
    if kind == "for_each":
        return f"{text}{_item(run, parent, tick)}"
    before = rounds[-2] if len(rounds) > 1 else None
    if kind == "retry" and before is not None:
        return f"{text}; attempt {len(rounds) - 1}: {end_with_cause(run, before)}"
    return text


def _item(run: PastRun, node: int, tick: int) -> str:
    path = run.index.nodes[node].path
    wrote = [
        place
        for places in run.index.writes.values()
        for place in places
        if place.writer == path and place.tick <= tick
    ]
    if not wrote:
        return ""
    last = max(wrote, key=lambda place: (place.tick, place.position))
    return f", {last.key.rpartition(':')[2]} = {brief(run.index.value_at(last))}"


def _parameters(run: PastRun, node: int) -> str:
    written = run.written(node)
    seconds = getattr(written.spec.model, "seconds", None) if written else None
    return f" of {seconds:g} s" if isinstance(seconds, int | float) else ""


def by_whom(run: PastRun, by: int) -> str:
    """Return the name of who halted a node."""
    return "the runner" if by == RUNNER else run.names.short(by)
