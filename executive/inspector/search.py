"""Finds ticks by an expression: `trace.probability < 0.5 and status('*dilate*') == RUNNING`.

The language is that of trees. A name is a key of the blackboard, with the value that it has
after the tick; what stands in quotes is a path, a name or a glob:

- `status('GLOB')`: what the nodes are after the tick; with several, equal to what any of them is;
- `asked('GLOB')`: whether one of them was ticked;
- `halted('GLOB')`: whether one of them was halted in the tick;
- `wrote('GLOB')`: whether a key was written in the tick;
- `key('GLOB')`: a key by its full name, where its bare name means several;
- `tick`, `time_s`, `duration_s`: of the tick itself.
"""

import ast
from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from executive.core.errors import InputError
from executive.engine.language.expression import Expression, parse_expression
from executive.inspector.index import INVALID, STATUSES, RunIndex
from executive.inspector.names import Names
from executive.inspector.recorded_values import opened

Ticks = NDArray[np.intp]
Ask = Callable[[int], object]

_CLOCK = ("tick", "time_s", "duration_s")


class AnyOf:
    """The statuses of several nodes: equal to a status when one of them is."""

    def __init__(self, statuses: frozenset[str]) -> None:
        """Hold the statuses."""
        self._statuses = statuses

    def __eq__(self, other: object) -> bool:
        return str(other) in self._statuses

    def __ne__(self, other: object) -> bool:
        return not self == other

    def __hash__(self) -> int:
        return hash(self._statuses)


class Question:
    """An expression over one recording, ready to be asked at any tick."""

    def __init__(self, text: str, index: RunIndex) -> None:
        """Parse it, and look up every name.

        Raises:
            InputError: It is no expression, or names what the recording does not have.
        """
        self.text = text
        self._index, self._names = index, Names(index)
        self._asks: dict[str, Ask] = {status.value: _constant(status.value) for status in STATUSES}
        self._changes: list[Ticks] = [np.zeros(1, np.intp)]
        self._expression = self._parsed(text)

    def matches(self) -> list[int]:
        """Return the ticks at which it is true.

        It is false where a key has no value yet, or none that it can be asked of.

        Raises:
            InputError: It could be asked at no tick at all, or is neither true nor false.
        """
        changes = np.unique(np.concatenate(self._changes))
        ends = [*changes[1:].tolist(), len(self._index)]
        found: list[int] = []
        troubles: list[InputError] = []
        for begin, end in zip(changes.tolist(), ends, strict=True):
            try:
                if self.holds(begin):
                    found += range(begin, end)
            except InputError as error:
                troubles.append(error)
        if troubles and len(troubles) == len(ends):
            raise troubles[-1]
        return found

    def holds(self, tick: int) -> bool:
        """Return whether it is true at a tick.

        Raises:
            InputError: It has no value there, or one that is neither true nor false.
        """
        value = self._expression.evaluate(_Moment(self._asks, tick))
        if not isinstance(value, bool | np.bool_):
            raise InputError(f"{self.text!r}: expected true or false, got {value!r}")
        return bool(value)

    def _parsed(self, text: str) -> Expression:
        try:
            tree = ast.parse(text.strip(), mode="eval")
        except (SyntaxError, ValueError, MemoryError, RecursionError):
            return parse_expression(text)  # says what is wrong
        named = ast.unparse(_Functions(self._function).visit(tree))
        expression = parse_expression(named)
        for name in sorted(expression.reads | expression.asks):
            if name not in self._asks:
                self._asks[name] = self._name(name)
        return expression

    def _function(self, function: str, pattern: str) -> str:
        """Make a name of a function of the recording, and return it."""
        name = f"{function}_{len(self._asks)}"
        self._asks[name] = getattr(self, f"_{function}")(pattern)
        return name

    def _name(self, name: str) -> Ask:
        if name not in _CLOCK:
            return self._key(name)
        self._changes.append(np.arange(len(self._index)))
        values = {"time_s": self._index.times_s, "duration_s": self._index.durations_s}
        return lambda tick: float(values[name][tick]) if name in values else tick

    def _key(self, pattern: str) -> Ask:
        places = self._index.writes[self._names.key(pattern)]
        ticks = [place.tick for place in places]
        self._changes.append(np.array(ticks, np.intp))

        def value(tick: int) -> object:
            place = bisect_right(ticks, tick) - 1
            if place < 0:
                raise KeyError(pattern)
            return opened(self._index.value_at(places[place]))

        return value

    def _status(self, pattern: str) -> Ask:
        table = self._index.statuses[:, list(self._names.nodes(pattern))]
        self._changes.append(np.flatnonzero((table[1:] != table[:-1]).any(axis=1)) + 1)
        return lambda tick: AnyOf(frozenset(STATUSES[code].value for code in table[tick]))

    def _asked(self, pattern: str) -> Ask:
        answers = self._index.answers[:, list(self._names.nodes(pattern))]
        return self._flag((answers != INVALID).max(axis=1))

    def _halted(self, pattern: str) -> Ask:
        nodes = frozenset(self._names.nodes(pattern))
        halted = np.zeros(len(self._index), np.bool_)
        for tick, halts in self._index.halts.items():
            halted[tick] = any(halt.node in nodes for halt in halts)
        return self._flag(halted)

    def _wrote(self, pattern: str) -> Ask:
        wrote = np.zeros(len(self._index), np.bool_)
        for key in self._names.keys(pattern):
            wrote[[place.tick for place in self._index.writes[key]]] = True
        return self._flag(wrote)

    def _flag(self, flags: NDArray[np.bool_]) -> Ask:
        self._changes.append(np.flatnonzero(flags[1:] != flags[:-1]) + 1)
        return lambda tick: bool(flags[tick])


FUNCTIONS = ("status", "asked", "halted", "wrote", "key")


def search(index: RunIndex, text: str) -> list[int]:
    """Return the ticks at which an expression is true.

    Raises:
        InputError: It is no expression, names what the recording does not have, or could be
            asked at no tick at all.
    """
    return Question(text, index).matches()


def spans(ticks: Sequence[int]) -> Iterator[tuple[int, int]]:
    """Return the first and last of each stretch of ticks that follow one another."""
    start = 0
    for place in range(1, len(ticks) + 1):
        if place == len(ticks) or ticks[place] != ticks[place - 1] + 1:
            yield ticks[start], ticks[place - 1]
            start = place


class _Functions(ast.NodeTransformer):
    """Puts a name in the place of every function that asks about the recording."""

    def __init__(self, name_of: Callable[[str, str], str]) -> None:
        self._name_of = name_of

    def visit_Call(self, node: ast.Call) -> ast.AST:
        match node:
            case ast.Call(func=ast.Name(id=function)) if function in FUNCTIONS:
                match node.args:
                    case [ast.Constant(value=str(pattern))] if not node.keywords:
                        return ast.Name(self._name_of(function, pattern), ast.Load())
                raise InputError(f"{function}() takes one text in quotes, as {function}('*grasp*')")
        return self.generic_visit(node)


class _Moment:
    """The names of a question at one tick."""

    def __init__(self, asks: dict[str, Ask], tick: int) -> None:
        self._asks, self._tick = asks, tick

    def __getitem__(self, name: str) -> object:
        return self._asks[name](self._tick)

    def __contains__(self, name: object) -> bool:
        try:
            self[str(name)]
        except KeyError:
            return False
        return True


def _constant(value: str) -> Ask:
    return lambda _: value
