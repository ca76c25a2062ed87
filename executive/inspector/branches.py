"""The branches of a tree that runs can take, node by node, and how often one run took each."""

import ast
from collections import Counter
from collections.abc import Iterator, Mapping
from itertools import product

import numpy as np

from executive.core.errors import InputError
from executive.engine.language.expression import Expression, parse_expression
from executive.engine.ticks import NodeStatus
from executive.inspector.deciding import SELECTORS, SEQUENCES, deciders
from executive.inspector.index import FAILURE, SUCCESS
from executive.inspector.past import PastRun
from executive.inspector.rebuilt import WrittenNode
from executive.inspector.times import attempts

Counts = Counter[str]

_ENDS = {NodeStatus.SUCCESS: "success", NodeStatus.FAILURE: "failure"}
_PASSING = ("inverter", "force_success", "force_failure")
_OWN = {"timeout": "ran out of time", "cooldown": "still rested", "run_once": "kept its answer"}
_MOST_PARTS = 8


def branches(run: PastRun, node: int) -> tuple[str, ...]:
    """Return every branch that a node has, in the words of reports."""
    return tuple(_branches(run, node))


def taken(run: PastRun, node: int) -> Counts:
    """Return how often a run took the branches of a node."""
    return Counter(_taken(run, node))


def _branches(run: PastRun, node: int) -> Iterator[str]:
    kind = run.index.nodes[node].kind
    children = [run.index.nodes[child].name for child in run.index.children[node]]
    if kind in SEQUENCES:
        yield "all succeeded"
        yield from (f"ended by failure of {name}" for name in _can_fail(run, node))
    elif kind in SELECTORS:
        yield from (f"ended by success of {name}" for name in children)
        if len(_can_fail(run, node)) == len(children):
            yield "all failed"
    elif kind == "retry":
        yield "first attempt succeeded"
        if run.times(node) != 1:
            yield "later attempt succeeded"
        yield "gave up"
    elif kind in ("when", "guard"):
        for keyword, expression in _conditions(run, node).items():
            yield from _condition_branches(keyword, expression)
    elif kind in _OWN:
        yield from ("answered as its child", _OWN[kind])
    elif kind == "set":
        yield "success"
    elif kind not in _PASSING:
        yield from ("success", "failure")


def _can_fail(run: PastRun, node: int) -> list[str]:
    """Return the names of the children that may fail: an assignment never does."""
    nodes = run.index.nodes
    return [nodes[c].name for c in run.index.children[node] if nodes[c].kind != "set"]


def _conditions(run: PastRun, node: int) -> Mapping[str, Expression]:
    written = run.written(node)
    return {} if written is None else written.conditions()


def _condition_branches(keyword: str, expression: Expression) -> Iterator[str]:
    prefix = "" if keyword == "when" else f"{keyword} "
    yield from (f"{prefix}true", f"{prefix}false")
    for part in parts_of(expression):
        yield from (f"{prefix}{part} decided, true", f"{prefix}{part} decided, false")


def _taken(run: PastRun, node: int) -> Iterator[str]:
    kind = run.index.nodes[node].kind
    if kind == "retry":
        yield from _retry_taken(run, node)
    elif kind in ("when", "guard"):
        yield from _conditions_taken(run, node)
    elif kind not in _PASSING:
        for tick in run.index.ended_ticks(node).tolist():
            yield _end_taken(run, node, kind, tick)


def _end_taken(run: PastRun, node: int, kind: str, tick: int) -> str:
    answer = run.index.answer(node, tick)
    if kind in _OWN:
        asked = any(run.index.answers[tick, child] for child in run.index.children[node])
        return "answered as its child" if asked else _OWN[kind]
    if kind in SEQUENCES and answer is NodeStatus.SUCCESS:
        return "all succeeded"
    if kind in SELECTORS and answer is NodeStatus.FAILURE:
        return "all failed"
    if kind in SEQUENCES or kind in SELECTORS:
        below = deciders(run.index, node, tick)
        name = run.index.nodes[below[-1][0]].name if below else "nothing"
        return f"ended by {_ENDS[answer]} of {name}"
    return _ENDS[answer]


def _retry_taken(run: PastRun, node: int) -> Iterator[str]:
    used = attempts(run.index, node)
    for life, count in zip(run.index.activations(node), used, strict=True):
        if life.status is NodeStatus.FAILURE:
            yield "gave up"
        elif life.status is NodeStatus.SUCCESS:
            yield "first attempt succeeded" if count == 1 else "later attempt succeeded"


def _conditions_taken(run: PastRun, node: int) -> Iterator[str]:
    written = run.written(node)
    if written is None:
        return
    index = run.index
    if not written.is_guard:
        for tick in index.ended_ticks(node).tolist():
            yield "true" if index.answers[tick, node] == SUCCESS else "false"
    for tick in _telling_ticks(run, node, written):
        for condition in run.conditions(node, tick):
            prefix = "" if condition.keyword == "when" else f"{condition.keyword} "
            if written.is_guard and condition.value is not None:
                yield f"{prefix}{'true' if condition.value else 'false'}"
            expression = written.conditions()[condition.keyword]
            yield from (f"{prefix}{part}" for part in _parts_taken(run, node, tick, expression))


def _telling_ticks(run: PastRun, node: int, written: WrittenNode) -> Iterator[int]:
    """Yield ticks in which a condition was asked of values that it had not been asked of.

    Those of a condition of one part are told by its answers alone.
    """
    conditions = written.conditions().values()
    if not written.is_guard and not any(parts_of(expression) for expression in conditions):
        return
    asked = np.flatnonzero(run.index.answers[:, node])
    keys = [key for key in written.reads() if key in run.index.writes]
    writes = np.unique([place.tick for key in keys for place in run.index.writes[key]])
    before = -1
    for tick in asked.tolist():
        epoch = int(np.searchsorted(writes, tick, "right"))
        in_doubt = bool(epoch) and writes[epoch - 1] == tick
        starts = written.is_guard and run.index.status(node, tick - 1) is not NodeStatus.RUNNING
        decided = written.is_guard and run.index.answers[tick, node] == FAILURE
        if epoch != before or in_doubt or starts or decided:
            yield tick
        before = epoch


def parts_of(expression: Expression) -> list[str]:
    """Return the parts that an expression joins by `and`, `or` and `not`; none for one part."""
    found: list[str] = []
    _leaves(expression.tree, found)
    several = list(dict.fromkeys(found))
    return several if 1 < len(several) <= _MOST_PARTS else []


def _leaves(node: ast.expr, found: list[str]) -> None:
    match node:
        case ast.BoolOp(values=values):
            for value in values:
                _leaves(value, found)
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            _leaves(operand, found)
        case _:
            found.append(ast.unparse(node))


def _joined(node: ast.expr, values: Mapping[str, bool]) -> bool:
    """Return what an expression comes to when its parts have these values."""
    match node:
        case ast.BoolOp(op=ast.And(), values=parts):
            return all(_joined(part, values) for part in parts)
        case ast.BoolOp(values=parts):
            return any(_joined(part, values) for part in parts)
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            return not _joined(operand, values)
    return values[ast.unparse(node)]


def _parts_taken(run: PastRun, node: int, tick: int, expression: Expression) -> Iterator[str]:
    """Yield the parts that decided: with the other value, the whole would have been another.

    A part that cannot be evaluated then, because `and` or `or` kept it from being asked, counts
    as either value: it decides nothing, and neither does what hangs on it.
    """
    written, parts = run.written(node), parts_of(expression)
    if written is None or not parts:
        return
    run.board.at(tick, node)
    known: dict[str, bool] = {}
    for part in parts:
        try:
            known[part] = bool(parse_expression(part).evaluate(written.names.scope))
        except InputError:
            continue
    unknown = [part for part in parts if part not in known]
    for part, value in known.items():
        fills = product((False, True), repeat=len(unknown))
        worlds = [{**known, **dict(zip(unknown, fill, strict=True))} for fill in fills]
        if all(
            _joined(expression.tree, world) != _joined(expression.tree, {**world, part: not value})
            for world in worlds
        ):
            yield f"{part} decided, {'true' if value else 'false'}"
