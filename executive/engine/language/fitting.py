"""Literals made to fit the types of ports, and values checked against them."""

import collections.abc
import dataclasses
import typing
from enum import Enum
from typing import Any

from executive.core.registry import closest
from executive.engine.language.porttypes import (
    bare,
    class_of,
    fixed_length,
    is_literal,
    is_mapping,
    is_one_of,
    is_sequence,
    item_type,
    mapping_types,
    type_name,
    union_members,
)

_SCALARS = (bool, int, float, str)


def fit(value: object, kind: Any) -> Any:
    """Return a literal as a value of a type.

    Enums are found by value, ints become floats, lists tuples or arrays, and mappings
    dataclasses, field by field.

    Raises:
        ValueError: It does not fit; the message says `expected ..., got ...`.
    """
    return _fit(value, bare(kind), literal=True)


def check(value: object, kind: Any) -> None:
    """Check that a value at run time has the type that its port declares.

    Raises:
        ValueError: It has not; the message says `expected ..., got ...`.
    """
    if type(value) is not kind:
        _fit(value, bare(kind), literal=False)


def _fit(value: object, kind: Any, *, literal: bool) -> Any:
    if kind is Any:
        return value
    if kind is None or kind is type(None):
        return _expect(value is None, value, kind)
    if members := union_members(kind):
        return _fit_any(value, members, kind, literal=literal)
    if is_literal(kind):
        return _expect(is_one_of(value, typing.get_args(kind)), value, kind)
    if is_sequence(kind):
        return _fit_sequence(value, kind, literal=literal)
    if is_mapping(kind):
        return _fit_mapping(value, kind, literal=literal)
    return _fit_class(value, class_of(kind), literal=literal)


def _fit_any(value: object, members: tuple[Any, ...], kind: Any, *, literal: bool) -> Any:
    for member in members:
        try:
            return _fit(value, bare(member), literal=literal)
        except ValueError:
            continue
    raise _misfit(value, kind)


def _fit_sequence(value: object, kind: Any, *, literal: bool) -> Any:
    if not isinstance(value, (list, tuple)):
        raise _misfit(value, kind)
    wanted = fixed_length(kind)
    if wanted is None:
        wanted = (item_type(kind),) * len(value)
    if len(wanted) != len(value):
        raise ValueError(f"expected {len(wanted)} items, got {len(value)}")
    items = [_fit(item, bare(want), literal=literal) for item, want in zip(value, wanted)]  # noqa: B905
    if not literal:
        return value
    return items if class_of(kind) is list else tuple(items)


def _fit_mapping(value: object, kind: Any, *, literal: bool) -> Any:
    if not isinstance(value, collections.abc.Mapping):
        raise _misfit(value, kind)
    key, item = map(bare, mapping_types(kind))
    fitted = {
        _fit(name, key, literal=literal): _fit(one, item, literal=literal)
        for name, one in value.items()
    }
    return fitted if literal else value


def _fit_class(value: object, kind: Any, *, literal: bool) -> Any:
    if kind in _SCALARS:
        return _fit_scalar(value, kind)
    if isinstance(value, kind):
        return value
    if literal and isinstance(kind, type):
        if issubclass(kind, Enum):
            return _fit_enum(value, kind)
        if dataclasses.is_dataclass(kind) and isinstance(value, dict):
            return _fit_fields(value, kind)
        if kind.__module__ == "numpy" and isinstance(value, list):
            return _fit_array(value)
    raise _misfit(value, kind)


def _fit_scalar(value: object, kind: type) -> object:
    if kind is float and isinstance(value, (int, float)) and not isinstance(value, bool):
        return float(value)
    is_number_not_bool = kind is bool or not isinstance(value, bool)
    return _expect(isinstance(value, kind) and is_number_not_bool, value, kind)


def _fit_enum(value: object, kind: type[Enum]) -> Enum:
    try:
        return kind(value)
    except ValueError:
        known = [str(member.value) for member in kind]
        raise ValueError(
            f"{kind.__name__} has no value {value!r}; {closest(str(value), known)}"
        ) from None


def _fit_fields(value: dict[str, object], kind: type) -> object:
    hints = typing.get_type_hints(kind)
    fields = {field.name: field for field in dataclasses.fields(kind) if field.init}
    unknown = [name for name in value if name not in fields]
    if unknown:
        raise ValueError(
            f"{kind.__name__} has no field {unknown[0]!r}; {closest(unknown[0], [*fields])}"
        )
    try:
        return kind(**{name: fit(item, hints[name]) for name, item in value.items()})
    except TypeError as error:
        raise ValueError(f"expected {kind.__name__}: {error}") from None


def _fit_array(value: list[object]) -> object:
    import numpy as np

    try:
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"expected an array of numbers, got {value!r}") from None


def _expect(fits: bool, value: object, kind: Any) -> object:
    if not fits:
        raise _misfit(value, kind)
    return value


def _misfit(value: object, kind: Any) -> ValueError:
    shown = repr(value) if isinstance(value, (*_SCALARS, type(None))) else type(value).__name__
    return ValueError(f"expected {type_name(kind)}, got {shown}")
