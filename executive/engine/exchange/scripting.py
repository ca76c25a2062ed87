"""Expressions and assignments of ours as scripts of BehaviorTree.CPP v4.

`and` and `or` bind equally there, and `!` and `-` take an atom, so what could be read in
another way stands in parentheses.
"""

import ast
from collections.abc import Mapping
from typing import Final

from executive.core.errors import InputError
from executive.engine.language.expression import parse_expression

_COMPARISONS: Final[Mapping[type[ast.cmpop], str]] = {
    ast.Eq: "==",
    ast.NotEq: "!=",
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
}
_ARITHMETIC: Final[Mapping[type[ast.operator], tuple[str, int]]] = {
    ast.Add: ("+", 4),
    ast.Sub: ("-", 4),
    ast.Mult: ("*", 5),
    ast.Div: ("/", 5),
}
_TERNARY, _LOGIC, _COMPARISON, _ATOM = 1, 2, 3, 6


def write_condition(text: str, *, turned: bool = False) -> str:
    """Return an expression as a script.

    Args:
        text: The expression.
        turned: Whether the script is true when the expression is false.

    Raises:
        InputError: It says what scripts cannot say.
    """
    tree = parse_expression(text).tree
    if turned and isinstance(tree, ast.UnaryOp) and isinstance(tree.op, ast.Not):
        return _Writer(text).of(tree.operand, 0)
    return _Writer(text).of(ast.UnaryOp(ast.Not(), tree) if turned else tree, 0)


def write_assignments(texts: Mapping[str, str]) -> str:
    """Return assignments as a script that makes them in the same order.

    Raises:
        InputError: An expression says what scripts cannot say.
    """
    return "; ".join(f"{key} := {write_condition(text)}" for key, text in texts.items())


class _Writer:
    def __init__(self, text: str) -> None:
        self._text = text

    def of(self, node: ast.expr, around: int) -> str:
        """Return a part of the expression, in parentheses where what is around it binds as much."""
        text, binds = self._bare(node)
        return f"({text})" if binds <= around else text

    def _bare(self, node: ast.expr) -> tuple[str, int]:
        match node:
            case ast.Name(id="none") | ast.Constant(value=None):
                raise self._error("none", "try a key of its own that says so")
            case ast.Name(id=name):
                return name, _ATOM
            case ast.Constant(value=value):
                return self._constant(value), _ATOM
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                return f"!{self.of(operand, _ATOM - 1)}", _ATOM - 1
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return f"-{self.of(operand, _ATOM - 1)}", _ATOM - 1
            case ast.BoolOp(op=op, values=values):
                sign = " && " if isinstance(op, ast.And) else " || "
                return sign.join(self.of(value, _LOGIC) for value in values), _LOGIC
            case ast.Compare():
                return self._comparison(node), _COMPARISON
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _ARITHMETIC:
                sign, binds = _ARITHMETIC[type(op)]
                return f"{self.of(left, binds - 1)} {sign} {self.of(right, binds)}", binds
            case ast.IfExp(test=test, body=body, orelse=orelse):
                parts = [self.of(part, _TERNARY) for part in (test, body, orelse)]
                return f"{parts[0]} ? {parts[1]} : {parts[2]}", _TERNARY
        raise self._error(ast.unparse(node), "try a skill that works it out")

    def _comparison(self, node: ast.Compare) -> str:
        text = self.of(node.left, _COMPARISON)
        for operator, operand in zip(node.ops, node.comparators, strict=True):
            if type(operator) not in _COMPARISONS:
                raise self._error(ast.unparse(node), "try == or !=")
            text += f" {_COMPARISONS[type(operator)]} {self.of(operand, _COMPARISON)}"
        return text

    def _constant(self, value: object) -> str:
        if isinstance(value, bool):
            return "true" if value else "false"
        if isinstance(value, str):
            if "'" in value or not value.isprintable():
                raise self._error(repr(value), "its texts have no quotes and no escapes")
            return f"'{value}'"
        return repr(value)

    def _error(self, part: str, hint: str) -> InputError:
        return InputError(f"{self._text!r}: scripts of BehaviorTree.CPP cannot say {part}; {hint}")
