"""One recorded run with everything that questions need: its index, names, trees and values."""

import ast
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from executive.core.errors import InputError, recording_named_by_the_user
from executive.engine.language.expression import Expression, parse_expression
from executive.engine.recording.reader import Recording
from executive.inspector.brief import brief
from executive.inspector.index import RunIndex, WritePlace
from executive.inspector.moments import PastBlackboard
from executive.inspector.names import Names
from executive.inspector.rebuilt import Rebuilt, WrittenNode


def open_with_ticks(path: Path) -> Recording:
    """Open a recording of a run that began.

    Raises:
        InputError: There is none at the path, or it holds no tick.
    """
    with recording_named_by_the_user():
        recording = Recording.open(path)
    if len(recording) == 0:
        raise InputError(f"{path}: holds no tick; the run was killed before the first one")
    return recording


@dataclass(frozen=True, slots=True)
class Condition:
    """What a condition came to when a node asked it.

    Attributes:
        keyword: `when`, `if`, `unless` or `while`.
        text: The expression.
        value: Whether it was true; None where the recording does not tell.
        terms: What it compares, with the values of then: `trace.end is "edge"`.
    """

    keyword: str
    text: str
    value: bool | None
    terms: tuple[str, ...]


class PastRun:
    """One recorded run, ready for questions.

    Attributes:
        recording: The recording.
        index: What happened when.
        names: Names of nodes, keys and ticks.
        board: The blackboard at a moment that questions move.
        trees: The trees as they were written.
    """

    def __init__(self, recording: Recording) -> None:
        """Read a recording through once."""
        self.recording = recording
        self.index = RunIndex(recording)
        self.names = Names(self.index)
        self.board = PastBlackboard(self.index)
        self.trees = Rebuilt(recording.header, self.board)

    @classmethod
    def open(cls, path: Path) -> "PastRun":
        """Open a recording.

        Raises:
            InputError: There is none at the path, or it holds no tick.
        """
        return cls(open_with_ticks(path))

    @cached_property
    def reads(self) -> dict[int, frozenset[str]]:
        """Keys that each node reads, by the wiring of the tree."""
        written = ((self.index.indices.get(path), node) for path, node in self.trees.nodes.items())
        return {index: node.reads() for index, node in written if index is not None}

    def written(self, node: int) -> WrittenNode | None:
        """Return a node as its file has it, None where the recording holds no sources."""
        return self.trees.nodes.get(self.index.nodes[node].path)

    def times(self, node: int) -> int | None:
        """Return how many rounds a retry or repeat has, None where its file gives no number."""
        written = self.written(node)
        times = getattr(written.spec.model, "times", None) if written else None
        return times if isinstance(times, int) else None

    def conditions(self, node: int, tick: int) -> list[Condition]:
        """Return what a condition or a guard asked in a tick, in the order of asking."""
        written = self.written(node)
        if written is None:
            return []
        life = self.index.activation(node, tick)
        starts = life is None or life.start == tick
        self.board.at(tick, node)
        asked = []
        for keyword, expression in written.conditions().items():
            if keyword in ("if", "unless") and not starts:
                continue
            asked.append(self._condition(keyword, expression, written))
            if asked[-1].value is (keyword == "unless"):
                break  # it has decided
        return asked

    def place(self, key: str) -> WritePlace | None:
        """Return the write whose value a key has at the moment of the blackboard."""
        return self.board.place(key)

    def _condition(self, keyword: str, expression: Expression, written: WrittenNode) -> Condition:
        try:
            value: object = expression.evaluate(written.names.scope)
        except InputError:
            value = None
        terms = tuple(self._term(text, written) for text in terms_of(expression))
        return Condition(keyword, expression.text, None if value is None else bool(value), terms)

    def _term(self, text: str, written: WrittenNode) -> str:
        expression = parse_expression(text)
        try:
            value = brief(_plain(expression.evaluate(written.names.scope)))
        except InputError:
            return f"{text} has no recorded value"
        return f"{text} is {value}{self._by(expression, written)}"

    def _by(self, expression: Expression, written: WrittenNode) -> str:
        """Return ` (look wrote it at @3)` where there is one writer to name."""
        places = [self.place(key) for name in expression.reads for key in written.names.keys(name)]
        wrote = [place for place in places if place is not None and place.writer]
        if len(wrote) != 1:
            return ""
        return f" ({self.names.of_path(wrote[0].writer)} wrote it at @{wrote[0].tick})"


def terms_of(expression: Expression) -> list[str]:
    """Return the parts of an expression that read the blackboard, as they are written."""
    found: list[str] = []

    def visit(node: ast.AST) -> None:
        if isinstance(node, ast.Name | ast.Attribute | ast.Subscript | ast.Call):
            text = ast.unparse(node)
            if "written(" not in text and parse_expression(text).reads:
                found.append(text)
            return
        for child in ast.iter_child_nodes(node):
            visit(child)

    visit(expression.tree)
    return list(dict.fromkeys(found))


def _plain(value: object) -> object:
    """Return a value in a form that `brief` can show."""
    if isinstance(value, bool | int | float | str | type(None)):
        return value
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    fields = vars(value) if hasattr(value, "__dict__") else None
    return {"$type": "value", **fields} if fields else str(value)
