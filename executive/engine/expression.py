"""Expressions over the blackboard, as in `size(knots) > 0 and trace.end == "edge"`.

The language is the part of Python's expressions that `simpleeval` evaluates, made smaller:
names, fields, items, comparisons, `and or not`, arithmetic and a few functions. A gate
refuses everything else when the expression is parsed, so no method is ever called and no
attribute that begins with an underscore is ever read.
"""

import ast
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final, Protocol

import simpleeval

from executive.core.errors import InputError
from executive.core.registry import closest

CONSTANTS: Final[Mapping[str, object]] = {"true": True, "false": False, "none": None}
FUNCTIONS: Final[Mapping[str, Callable[..., Any]]] = {
    "abs": abs,
    "max": max,
    "min": min,
    "round": round,
    "size": len,
}
WRITTEN: Final = "written"
"""Function that says whether a key has a value yet; its argument is not read."""

_FORMS: Final = (
    ast.Attribute,
    ast.BinOp,
    ast.BoolOp,
    ast.Call,
    ast.Compare,
    ast.Constant,
    ast.IfExp,
    ast.List,
    ast.Name,
    ast.Subscript,
    ast.Tuple,
    ast.UnaryOp,
)
_OPERATORS: Final[Mapping[type, Any]] = {
    kind: simpleeval.DEFAULT_OPERATORS[kind]
    for kind in (
        *(ast.Add, ast.Sub, ast.Mult, ast.Div, ast.Mod, ast.FloorDiv, ast.USub, ast.UAdd),
        *(ast.Eq, ast.NotEq, ast.Gt, ast.Lt, ast.GtE, ast.LtE, ast.Not),
        *(ast.In, ast.NotIn, ast.Is, ast.IsNot),
    )
}
_WORDS: Final = (ast.And, ast.Or, ast.Load)


class Scope(Protocol):
    """Where an expression finds its names."""

    def __getitem__(self, name: str, /) -> object:
        """Return the value of a name; KeyError where it has none yet."""
        ...

    def __contains__(self, name: object, /) -> bool:
        """Return whether a name has a value."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Expression:
    """An expression that has passed the gate.

    Attributes:
        text: As it was written.
        tree: Its syntax tree.
        reads: Names that it needs.
        asks: Names that it only asks about, with `written(name)`.
    """

    text: str
    tree: ast.expr
    reads: frozenset[str]
    asks: frozenset[str]

    def evaluate(self, scope: Scope) -> object:
        """Return its value.

        Raises:
            InputError: A name has no value yet, or an operation fails.
        """
        functions = {**FUNCTIONS, WRITTEN: scope.__contains__}
        evaluator = simpleeval.EvalWithCompoundTypes(_OPERATORS, functions, _Names(scope))
        try:
            return evaluator.eval(self.text, previously_parsed=self.tree)
        except simpleeval.NameNotDefined as error:
            raise InputError(
                f"{self.text!r}: {error.name!r} has no value: nothing has written it yet"
            ) from None
        except simpleeval.InvalidExpression as error:
            raise InputError(f"{self.text!r}: {error}") from error
        except (ArithmeticError, LookupError, TypeError, ValueError) as error:
            raise InputError(f"{self.text!r}: {type(error).__name__}: {error}") from error


class _Names:
    """The constants, and then the names of a scope."""

    def __init__(self, scope: Scope) -> None:
        self._scope = scope

    def __getitem__(self, name: str) -> object:
        return CONSTANTS[name] if name in CONSTANTS else self._scope[name]


def parse_expression(text: str) -> Expression:
    """Parse an expression and pass it through the gate.

    Raises:
        InputError: It is no expression, or uses what the language does not have.
    """
    try:
        tree = ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, MemoryError, RecursionError) as error:
        what = getattr(error, "msg", None) or error
        raise InputError(f"{text!r} is not an expression: {what}") from None
    gate = _Gate(text)
    tree = gate.visit(tree)
    return Expression(text, tree, frozenset(gate.reads), frozenset(gate.asks))


class _Gate(ast.NodeTransformer):
    """Lets through what the language has, and notes the names."""

    def __init__(self, text: str) -> None:
        self._text = text
        self.reads: set[str] = set()
        self.asks: set[str] = set()

    def visit(self, node: ast.AST) -> Any:
        allowed = (*_FORMS, *_OPERATORS, *_WORDS)
        if not isinstance(node, allowed):
            raise InputError(f"{self._text!r}: {_shown(node)} is not part of the language")
        return super().visit(node)

    def visit_Name(self, node: ast.Name) -> ast.expr:
        if node.id not in CONSTANTS:
            self.reads.add(node.id)
        return node

    def visit_Constant(self, node: ast.Constant) -> ast.expr:
        if not isinstance(node.value, (bool, int, float, str, type(None))):
            raise InputError(f"{self._text!r}: {node.value!r} is not part of the language")
        return node

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        if node.attr.startswith("_"):
            raise InputError(f"{self._text!r}: field {node.attr!r} is private")
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


def _shown(node: ast.AST) -> str:
    return repr(ast.unparse(node)) if isinstance(node, ast.expr) else type(node).__name__.lower()
