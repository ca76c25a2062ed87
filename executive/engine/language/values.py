"""What stands at an input: a literal, or an expression behind a `$`.

`$image` reads a key, `$size(knots) - 1` works something out, `$$x` is the text `$x`.
"""

import ast
from dataclasses import dataclass
from typing import Any

from executive.core.errors import InputError
from executive.engine.language.expression import Expression, parse_expression
from executive.engine.language.fitting import fit


@dataclass(frozen=True, slots=True)
class Literal:
    """A value that is written out."""

    value: object


Value = Literal | Expression


def parse_value(raw: object) -> Value:
    """Return what a value in a file means.

    Raises:
        InputError: What follows the `$` is no expression, or a `$` is hidden in a list.
    """
    if isinstance(raw, str) and raw.startswith("$"):
        return Literal(raw[1:]) if raw.startswith("$$") else parse_expression(raw[1:])
    hidden = _reference_inside(raw)
    if hidden is not None:
        raise InputError(
            f"{hidden!r} inside a literal is plain text; try an expression such as '$[a, b]'"
        )
    return Literal(raw)


def fitted(value: Value, kind: Any) -> Value:
    """Return a literal as a value of a type; an expression as it is.

    Raises:
        ValueError: The literal does not fit.
    """
    return Literal(fit(value.value, kind)) if isinstance(value, Literal) else value


def key_of(value: Value) -> str | None:
    """Return the key that a value only refers to, None where it is more than that."""
    is_name = isinstance(value, Expression) and isinstance(value.tree, ast.Name)
    reads = value.reads if isinstance(value, Expression) else frozenset()
    return next(iter(reads), None) if is_name else None


def _reference_inside(raw: object) -> str | None:
    items = raw.values() if isinstance(raw, dict) else raw if isinstance(raw, list) else ()
    for item in items:
        if isinstance(item, str) and item.startswith("$"):
            return item
        if (hidden := _reference_inside(item)) is not None:
            return hidden
    return None
