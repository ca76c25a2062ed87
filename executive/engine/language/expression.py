"""Expressions over the blackboard, as in `size(knots) > 0 and trace.end == "edge"`.

The language is a small part of Python's expressions: names, fields, items, comparisons,
`and or not`, arithmetic and a few functions. A gate refuses everything else when the
expression is parsed, so no method is ever called and no attribute that begins with an
underscore is ever read; `executive.engine.language.evaluation` makes a function of what is left.
"""

import ast
import re
import warnings
from dataclasses import dataclass
from typing import Any, Final

from executive.core.errors import InputError
from executive.core.registry import closest
from executive.engine.language.evaluation import (
    CONSTANTS,
    FORMS,
    FUNCTIONS,
    OPERATORS,
    WRITTEN,
    Evaluate,
    NoValueError,
    Scope,
    compiled,
)

MAX_NESTING: Final = 60
"""How deep an expression may be nested; a tick evaluates it in nested calls."""

_ALLOWED: Final = (*FORMS, *OPERATORS, ast.And, ast.Or, ast.Load)
_OTHERWISE: Final = (
    (r"&&", "and"),
    (r"\|\|", "or"),
    (r"!(?!=)", "not"),
    (r"(?<![=<>!:])=(?!=)", "=="),
    (r"\$", "keys without a $ inside an expression"),
    (r"\?", "a if c else b"),
)
_FRAMES: Final = ("ag_frame", "cr_frame", "gi_frame", "tb_frame")


@dataclass(frozen=True, slots=True, eq=False)
class Expression:
    """An expression that has passed the gate.

    Attributes:
        text: As it was written.
        tree: Its syntax tree.
        reads: Names that it needs.
        asks: Names that it only asks about, with `written(name)`.
        function: What it comes to, as a function of the names.
    """

    text: str
    tree: ast.expr
    reads: frozenset[str]
    asks: frozenset[str]
    function: Evaluate

    def evaluate(self, scope: Scope) -> Any:
        """Return its value.

        Raises:
            InputError: A name has no value yet, or an operation fails.
        """
        try:
            return self.function(scope)
        except NoValueError as error:
            raise InputError(
                f"{self.text!r}: {error.args[0]!r} has no value: nothing has written it yet"
            ) from None
        except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
            raise InputError(f"{self.text!r}: {type(error).__name__}: {error}") from error


def parse_expression(text: str) -> Expression:
    """Parse an expression and pass it through the gate.

    Raises:
        InputError: It is no expression, or uses what the language does not have.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # what Python only warns of is a mistake here
            tree = ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, MemoryError, RecursionError, Warning) as error:
        what = getattr(error, "msg", None) or error
        raise InputError(f"{text!r} is not an expression: {what}{_hint(text)}") from None
    gate = _Gate(text)
    tree = gate.visit(tree)
    return Expression(text, tree, frozenset(gate.reads), frozenset(gate.asks), compiled(tree))


def _hint(text: str) -> str:
    """Say what is written otherwise here, for what other languages write."""
    bare = re.sub(r"\"[^\"]*\"|'[^']*'", "", text)
    for pattern, ours in _OTHERWISE:
        if re.search(pattern, bare):
            return f"; try {ours}"
    return ""


class _Gate(ast.NodeTransformer):
    """Lets through what the language has, and notes the names."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._level = 0
        self.reads: set[str] = set()
        self.asks: set[str] = set()

    def visit(self, node: ast.AST) -> Any:
        if self._level > MAX_NESTING:
            raise InputError(
                f"{self._text[:60]!r}...: nested more than {MAX_NESTING} deep; try keys for parts"
            )
        if not isinstance(node, _ALLOWED):
            raise InputError(f"{self._text!r}: {_shown(node)} is not part of the language")
        self._level += 1
        visited = super().visit(node)
        self._level -= 1
        return visited

    def visit_Name(self, node: ast.Name) -> ast.expr:
        if node.id not in CONSTANTS:
            self.reads.add(node.id)
        return node

    def visit_Constant(self, node: ast.Constant) -> ast.expr:
        if not isinstance(node.value, (bool, int, float, str, type(None))):
            raise InputError(f"{self._text!r}: {node.value!r} is not part of the language")
        return node

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        if node.attr.startswith(("_", "func_")) or node.attr in _FRAMES:
            raise InputError(f"{self._text!r}: field {node.attr!r} is private")
        return self.generic_visit(node)

    def visit_Compare(self, node: ast.Compare) -> ast.AST:
        for test, value in zip(node.ops, node.comparators, strict=True):
            if isinstance(test, (ast.Is, ast.IsNot)) and not _is_constant(value):
                raise InputError(
                    f"{self._text!r}: 'is' asks for none, true or false; try == for other values"
                )
        return self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> ast.expr:
        known = [*FUNCTIONS, WRITTEN]
        name = node.func.id if isinstance(node.func, ast.Name) else ast.unparse(node.func)
        if name not in known:
            raise InputError(f"{self._text!r}: unknown function {name!r}; {closest(name, known)}")
        if node.keywords or not node.args:
            raise InputError(f"{self._text!r}: {name}() takes values in order, at least one")
        if name == WRITTEN:
            return self._written(node)
        node.args = [self.visit(argument) for argument in node.args]
        return node

    def _written(self, node: ast.Call) -> ast.expr:
        match node.args:
            case [ast.Name(id=name)]:
                self.asks.add(name)
                node.args = [ast.Constant(name)]
                return node
        raise InputError(f"{self._text!r}: {WRITTEN}() asks for one name, as in written(trace)")


def _is_constant(node: ast.expr) -> bool:
    """Return whether there is only one value that a part of an expression can be."""
    if isinstance(node, ast.Constant):
        return node.value is None or isinstance(node.value, bool)
    return isinstance(node, ast.Name) and node.id in CONSTANTS


def _shown(node: ast.AST) -> str:
    return repr(ast.unparse(node)) if isinstance(node, ast.expr) else type(node).__name__.lower()
