"""Units of expressions, worked out from the units that ports declare.

Only what is sure is said: a number that is written out takes the unit of its neighbour, and a
product has none that is known, since `length_m * 1000` may be meant as millimetres. Nothing is
ever converted.
"""

import ast
from collections.abc import Callable, Mapping
from typing import Any, Final, cast

from executive.core.errors import InputError
from executive.engine.language.expression import Expression

_SAME_UNIT: Final = (ast.Add, ast.Sub, ast.Mod)


def unit_of(expression: Expression, units: Mapping[str, str]) -> str:
    """Return the unit of an expression, empty where it cannot be told.

    Args:
        expression: What to look at.
        units: Units of the keys; a key that is missing, or empty, may be in any.

    Raises:
        InputError: It adds or compares what is in two units.
    """
    try:
        return _Units(units).of(expression.tree)
    except InputError as error:
        raise InputError(f"{expression.text!r}: {error}") from None


class _Units:
    def __init__(self, units: Mapping[str, str]) -> None:
        self._units = units
        self._rules: Mapping[type, Callable[[Any], str]] = {
            ast.Name: lambda node: self._units.get(node.id, ""),
            ast.BinOp: self._binary,
            ast.UnaryOp: lambda node: self.of(node.operand),
            ast.Compare: self._compare,
            ast.IfExp: self._if_exp,
            ast.Call: self._call,
            ast.Subscript: self._subscript,
        }

    def of(self, node: ast.expr) -> str:
        rule = self._rules.get(type(node))
        return rule(node) if rule else self._look_below(node)

    def _look_below(self, node: ast.expr) -> str:
        for part in ast.iter_child_nodes(node):
            if isinstance(part, ast.expr):
                self.of(part)
        return ""

    def _binary(self, node: ast.BinOp) -> str:
        if isinstance(node.op, _SAME_UNIT):
            return self._common(node.left, node.right)
        return self._look_below(node)

    def _compare(self, node: ast.Compare) -> str:
        self._common(node.left, *node.comparators)
        return ""

    def _if_exp(self, node: ast.IfExp) -> str:
        self.of(node.test)
        return self._common(node.body, node.orelse)

    def _call(self, node: ast.Call) -> str:
        name = cast(ast.Name, node.func).id
        if name in ("max", "min"):
            return self._common(*node.args)
        if name in ("abs", "round"):
            first, *_ = [self.of(argument) for argument in node.args]
            return first
        return self._look_below(node)

    def _subscript(self, node: ast.Subscript) -> str:
        self.of(node.slice)
        return self.of(node.value)

    def _common(self, *nodes: ast.expr) -> str:
        """Return the unit of things that are added or compared."""
        known = {self.of(node): node for node in reversed(nodes)}
        known.pop("", None)
        if len(known) > 1:
            shown = " and ".join(
                f"{ast.unparse(node)} in {unit}" for unit, node in reversed(known.items())
            )
            raise InputError(f"{shown} do not go together; try a skill that converts")
        return next(iter(known), "")
