"""Types of ports: their names in YAML, what they are made of, and which may stand for which.

Names are `bool int float str any`, those that the application registers, `list[T]`,
`dict[str, T]`, `tuple[A, B]`, `"word" | "other"` and `T | None`. A `list[T]` is any ordered
collection: a skill may ask for a tuple or give one. An int fits where a float is asked for; a
bool is no number.
"""

import ast
import collections.abc
import types
import typing
from collections.abc import Sequence
from typing import Any, Literal, Union

from executive.core.errors import InputError
from executive.core.registry import Registry, closest
from executive.engine.language.counts import NodeCounts
from executive.engine.ticks import NodeStatus

_BUILT_IN: dict[str, Any] = {
    "any": Any,
    "bool": bool,
    "float": float,
    "int": int,
    "str": str,
    "NodeCounts": NodeCounts,
    "NodeStatus": NodeStatus,
}
_SEQUENCES = (list, tuple, collections.abc.Sequence)
_MAPPINGS = (dict, collections.abc.Mapping)


def parse_type(text: str, registered: Registry[type]) -> Any:
    """Return the type that a name in YAML stands for.

    Args:
        text: Such as `float`, `list[Knot]` or `CameraFrame | None`.
        registered: Types of the application by name.

    Raises:
        InputError: No such type, or not written like one.
    """
    try:
        tree = ast.parse(text.strip(), mode="eval").body
    except SyntaxError:
        raise InputError(_no_type(text)) from None
    return _type_of(tree, text, registered)


def _type_of(tree: ast.expr, text: str, registered: Registry[type]) -> Any:
    match tree:
        case ast.Name(id=name):
            return _named(name, registered)
        case ast.Constant(value=None):
            return type(None)
        case ast.Constant(value=str(word)):
            return Literal[word]
        case ast.Subscript(value=ast.Name(id="dict"), slice=ast.Tuple(elts=[key, item])):
            kinds = [_type_of(part, text, registered) for part in (key, item)]
            return collections.abc.Mapping[*kinds]  # type: ignore[misc, valid-type]  # at run time
        case ast.Subscript(value=ast.Name(id="tuple"), slice=ast.Tuple(elts=items)) if items:
            return tuple[tuple(_type_of(item, text, registered) for item in items)]  # type: ignore[misc]  # at run time
        case ast.Subscript(value=ast.Name(id="list"), slice=item):
            return Sequence[_type_of(item, text, registered)]  # type: ignore[misc]  # at run time
        case ast.BinOp(left=left, op=ast.BitOr(), right=right):
            return _either(_type_of(left, text, registered), _type_of(right, text, registered))
    raise InputError(_no_type(text))


def _either(*kinds: Any) -> Any:
    """Return the union of some types, with one literal type for all words in it."""
    members = [member for kind in kinds for member in union_members(kind) or (kind,)]
    words = [word for one in members if is_literal(one) for word in typing.get_args(one)]
    others = [one for one in members if not is_literal(one)]
    literal = [Literal[tuple(words)]] if words else []
    return Union[(*literal, *others)]


def is_literal(kind: Any) -> bool:
    """Return whether a type is some words or values."""
    return typing.get_origin(kind) is Literal


def _named(name: str, registered: Registry[type]) -> Any:
    if name in registered:
        return registered.get(name)
    if name in _BUILT_IN:
        return _BUILT_IN[name]
    known = [*_BUILT_IN, *registered, "list[...]", "dict[...]", "tuple[...]"]
    raise InputError(f"unknown type {name!r}; {closest(name, known)}")


def _no_type(text: str) -> str:
    return (
        f"{text!r} is not a type; expected a name, list[NAME], dict[str, NAME], "
        "tuple[NAME, NAME] or NAME | None"
    )


def type_name(kind: Any) -> str:
    """Return a type as a message shows it: `list[Knot]`, `float | None`."""
    kind = bare(kind)
    if kind is Any:
        return "any"
    if kind is None or kind is type(None):
        return "None"
    members = union_members(kind)
    if members:
        return " | ".join(type_name(member) for member in members)
    if is_literal(kind):
        return " | ".join(repr(value) for value in typing.get_args(kind))
    if (items := fixed_length(kind)) is not None:
        return f"tuple[{', '.join(type_name(item) for item in items)}]"
    if is_mapping(kind):
        return f"dict[{', '.join(type_name(part) for part in mapping_types(kind))}]"
    if is_sequence(kind):
        return f"list[{type_name(item_type(kind))}]"
    return str(getattr(class_of(kind), "__name__", kind))


def literal_type(value: object) -> Any:
    """Return the type of a value as it stands in a file."""
    if isinstance(value, list):
        return list[Any]
    return dict[str, Any] if isinstance(value, dict) else type(value)


def union_members(kind: Any) -> tuple[Any, ...]:
    """Return the members of a union, nothing for any other type."""
    if typing.get_origin(kind) in (Union, types.UnionType):
        return typing.get_args(kind)
    return ()


def is_sequence(kind: Any) -> bool:
    """Return whether a type is an ordered collection other than a string."""
    return class_of(bare(kind)) in _SEQUENCES


def item_type(kind: Any) -> Any:
    """Return the type of the items of an ordered collection."""
    items = [arg for arg in typing.get_args(bare(kind)) if arg is not Ellipsis]
    if not items:
        return Any
    return items[0] if len(set(items)) == 1 else Union[tuple(items)]  # noqa: UP007 - values


def is_mapping(kind: Any) -> bool:
    """Return whether a type holds values by key."""
    return class_of(bare(kind)) in _MAPPINGS


def mapping_types(kind: Any) -> tuple[Any, Any]:
    """Return the types of the keys and of the values of a mapping."""
    args = typing.get_args(bare(kind))
    return (args[0], args[1]) if len(args) == 2 else (Any, Any)


def accepts(target: Any, source: Any) -> bool:
    """Return whether every value of type `source` may stand where `target` is asked for."""
    target, source = bare(target), bare(source)
    if Any in (target, source) or target == source:
        return True
    if members := union_members(source):
        return all(accepts(target, member) for member in members)
    if members := union_members(target):
        return any(accepts(member, source) for member in members)
    if is_literal(target) or is_literal(source):
        return _literal_accepts(target, source)
    if is_sequence(target):
        return is_sequence(source) and _sequence_accepts(target, source)
    if is_mapping(target):
        parts = zip(mapping_types(target), mapping_types(source), strict=True)
        return is_mapping(source) and all(accepts(wanted, given) for wanted, given in parts)
    return _class_accepts(class_of(target), class_of(source))


def _literal_accepts(target: Any, source: Any) -> bool:
    if not is_literal(source):
        return False
    values = typing.get_args(source)
    if is_literal(target):
        return all(is_one_of(value, typing.get_args(target)) for value in values)
    return all(accepts(target, type(value)) for value in values)


def _sequence_accepts(target: Any, source: Any) -> bool:
    wanted, given = fixed_length(target), fixed_length(source)
    if wanted is not None and given is not None:
        return len(wanted) == len(given) and all(map(accepts, wanted, given))
    return accepts(item_type(target), item_type(source))


def fixed_length(kind: Any) -> tuple[Any, ...] | None:
    """Return the types of the items of a tuple that has as many; None for any other type."""
    args = typing.get_args(kind)
    is_tuple = class_of(kind) is tuple and bool(args)
    return args if is_tuple and Ellipsis not in args else None


def _class_accepts(target: Any, source: Any) -> bool:
    if source is bool:
        return target is bool
    if target is float:
        return source in (int, float)
    try:
        return issubclass(source, target)
    except TypeError:  # a protocol with data members: only a value can tell
        return True


def is_one_of(value: object, members: tuple[object, ...]) -> bool:
    """Return whether a value is one of a literal type's; `true` is not 1 there."""
    return any(type(value) is type(member) and value == member for member in members)


def bare(kind: Any) -> Any:
    """Return a type without what `Annotated` adds."""
    return typing.get_args(kind)[0] if typing.get_origin(kind) is typing.Annotated else kind


def class_of(kind: Any) -> Any:
    """Return the class of a type, whatever its items are."""
    return typing.get_origin(kind) or kind
