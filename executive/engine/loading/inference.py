"""Types of expressions, worked out from the types of the keys that they read."""

import ast
import dataclasses
import typing
from collections.abc import Callable, Mapping
from enum import Enum
from typing import Any, Final, Union

from executive.core.errors import InputError
from executive.core.registry import closest
from executive.engine.language.evaluation import CONSTANTS, WRITTEN
from executive.engine.language.expression import Expression
from executive.engine.language.porttypes import (
    accepts,
    is_mapping,
    is_sequence,
    item_type,
    mapping_types,
    type_name,
    union_members,
)

_NUMERIC_FUNCTIONS: Final = ("abs", "max", "min", "round")
_ORDERINGS: Final = (ast.Lt, ast.LtE, ast.Gt, ast.GtE)


def infer(expression: Expression, keys: Mapping[str, Any]) -> Any:
    """Return the type of an expression, `Any` where it cannot be told.

    Args:
        expression: What to look at.
        keys: Types of the keys; a key that is missing may be anything.

    Raises:
        InputError: It can never work: no such field, an enum without such a value, an order
            of things that have none.
    """
    try:
        return _Inference(keys).of(expression.tree)
    except InputError as error:
        raise InputError(f"{expression.text!r}: {error}") from None


class _Inference:
    def __init__(self, keys: Mapping[str, Any]) -> None:
        self._keys = keys
        self._rules: Mapping[type, Callable[[Any], Any]] = {
            ast.Constant: lambda node: type(node.value),
            ast.Name: self._name,
            ast.Attribute: self._attribute,
            ast.Subscript: self._subscript,
            ast.Compare: self._compare,
            ast.BoolOp: self._bool_op,
            ast.UnaryOp: self._unary,
            ast.BinOp: self._binary,
            ast.IfExp: lambda node: _union(self.of(node.body), self.of(node.orelse)),
            ast.Call: self._call,
            ast.List: self._items,
            ast.Tuple: self._items,
        }

    def of(self, node: ast.expr) -> Any:
        return self._rules[type(node)](node)

    def _name(self, node: ast.Name) -> Any:
        if node.id in CONSTANTS:
            return type(CONSTANTS[node.id])
        return self._keys.get(node.id, Any)

    def _attribute(self, node: ast.Attribute) -> Any:
        owner = self.of(node.value)
        if owner is Any:
            return Any
        members = union_members(owner) or (owner,)
        kinds = [_field_type(member, node.attr) for member in members if member is not type(None)]
        if not kinds or type(None) in members:
            raise InputError(f"{ast.unparse(node.value)} may be None, which has no fields")
        return _union(*kinds)

    def _subscript(self, node: ast.Subscript) -> Any:
        self.of(node.slice)
        owner = self.of(node.value)
        if is_mapping(owner):
            return mapping_types(owner)[1]
        return item_type(owner) if is_sequence(owner) else Any

    def _compare(self, node: ast.Compare) -> Any:
        operands = [node.left, *node.comparators]
        kinds = [self.of(operand) for operand in operands]
        for i, operator in enumerate(node.ops):
            left, right = kinds[i], kinds[i + 1]
            if isinstance(operator, (ast.Eq, ast.NotEq)):
                _check_equality(left, operands[i + 1], right)
                _check_equality(right, operands[i], left)
            if isinstance(operator, _ORDERINGS) and not (_has_order(left) and _has_order(right)):
                shown = f"{type_name(left)} with {type_name(right)}"
                raise InputError(f"cannot order {shown}; try a number, a field or size()")
        return bool

    def _bool_op(self, node: ast.BoolOp) -> Any:
        for value in node.values:
            self._require_bool(value)
        return bool

    def _unary(self, node: ast.UnaryOp) -> Any:
        if isinstance(node.op, ast.Not):
            self._require_bool(node.operand)
            return bool
        return self._number(node.operand)

    def _binary(self, node: ast.BinOp) -> Any:
        left, right = self.of(node.left), self.of(node.right)
        if str in (left, right) or is_sequence(left) or is_sequence(right) or _array(left, right):
            return left if left == right else Any
        kind = _union(self._number(node.left), self._number(node.right))
        whole = kind is int and not isinstance(node.op, ast.Div)
        return Any if kind is Any else int if whole else float

    def _call(self, node: ast.Call) -> Any:
        name = typing.cast(ast.Name, node.func).id
        kinds = [self.of(argument) for argument in node.args]
        if name == WRITTEN:
            return bool
        if name == "size":
            _check_sized(kinds[0])
            return int
        several = len(kinds) > 1 and name in _NUMERIC_FUNCTIONS
        return _union(*kinds) if several or name == "abs" else Any

    def _items(self, node: ast.List | ast.Tuple) -> Any:
        kinds = [self.of(item) for item in node.elts]
        return list[_union(*kinds)] if kinds else list[Any]  # type: ignore[misc]  # run time

    def _require_bool(self, node: ast.expr) -> None:
        kind = self.of(node)
        if not accepts(bool, kind):
            raise InputError(
                f"{ast.unparse(node)} is {type_name(kind)}, not true or false; try a comparison"
            )

    def _number(self, node: ast.expr) -> Any:
        kind = self.of(node)
        if not accepts(float, kind) and not _array(kind):
            raise InputError(f"{ast.unparse(node)} is {type_name(kind)}, not a number")
        return kind


def _union(*kinds: Any) -> Any:
    if Any in kinds:
        return Any
    distinct = tuple(dict.fromkeys(kinds))
    if set(distinct) == {int, float}:
        return float
    return distinct[0] if len(distinct) == 1 else Union[distinct]  # noqa: UP007 - values


def _field_type(owner: Any, field: str) -> Any:
    if is_mapping(owner):  # its items are its fields
        return mapping_types(owner)[1]
    kind = typing.get_origin(owner) or owner
    if owner is Any or not isinstance(kind, type) or kind.__module__ == "numpy":
        return Any
    if dataclasses.is_dataclass(kind):
        hints = typing.get_type_hints(kind)
        if field in hints:
            return _without_class_var(hints[field])
    member = getattr(kind, field, None)
    if isinstance(member, property):
        return typing.get_type_hints(member.fget).get("return", Any) if member.fget else Any
    known = [name for name in vars(kind) if not name.startswith("_")]
    if dataclasses.is_dataclass(kind):
        known = [f.name for f in dataclasses.fields(kind)]
    raise InputError(f"{kind.__name__} has no field {field!r}; {closest(field, known)}")


def _without_class_var(hint: Any) -> Any:
    """Return the type of a field that belongs to the class, or the hint as it is."""
    if typing.get_origin(hint) is typing.ClassVar:
        return typing.get_args(hint)[0]
    return hint


def _check_equality(kind: Any, literal: ast.expr, other: Any) -> None:
    """Refuse to compare an enum with a text that is none of its values."""
    if isinstance(kind, type) and issubclass(kind, Enum) and isinstance(literal, ast.Constant):
        known = [str(member.value) for member in kind]
        if other is str and literal.value not in known:
            raise InputError(
                f"{kind.__name__} has no value {literal.value!r}; "
                f"{closest(str(literal.value), known)}"
            )


def _has_order(kind: Any) -> bool:
    return kind is str or accepts(float, kind) or _array(kind)


def _array(*kinds: Any) -> bool:
    return any(
        getattr(typing.get_origin(kind) or kind, "__module__", "") == "numpy" for kind in kinds
    )


def _check_sized(kind: Any) -> None:
    if any(member in (bool, int, float, type(None)) for member in union_members(kind) or (kind,)):
        raise InputError(f"{type_name(kind)} has no size")
