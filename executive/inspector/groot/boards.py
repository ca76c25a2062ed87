"""Blackboards as MessagePack, in the form in which BehaviorTree.CPP sends values of its own.

There each subtree has a blackboard of its own, named by the path of the subtree, and the main
tree one with the tree's name. An object of a class carries its class as `__type`.
"""

from collections.abc import Mapping, Sequence
from math import prod
from typing import Final

import umsgpack

from executive.engine.recording.reader import KeyState
from executive.inspector.brief import brief

MOST_ITEMS: Final = 64
"""Longer lists are sent as one line of text: clients ask for every key several times a second."""

_INTEGERS: Final = range(-(2**63), 2**64)
_UNSET: Final = "executive.engine.blackboard.Unset"


def blackboards(
    board: Mapping[str, KeyState], owners: Mapping[str, str], names: Sequence[str]
) -> dict[str, dict[str, object]]:
    """Return the values of some blackboards by name and key.

    Args:
        board: What the blackboard holds, by full key.
        owners: Name of the blackboard that a key is on, by what the key begins with.
        names: Names of blackboards; without any, all of them. What is no name is left out.
    """
    known = dict.fromkeys(owners.values())
    chosen = [name for name in names if name in known] if names else [*known]
    found: dict[str, dict[str, object]] = {name: {} for name in chosen}
    for key, state in board.items():
        owner, _, name = key.rpartition(":")
        path = owners.get(owner)
        if path in found and not _is_unset(state.value):
            found[path][name] = _plain(state.value)
    return found


def packed(values: Mapping[str, Mapping[str, object]]) -> bytes:
    """Return blackboards as MessagePack; nil where there is none, as BehaviorTree.CPP does."""
    data: bytes = umsgpack.packb(dict(values) or None)
    return data


def _is_unset(value: object) -> bool:
    return isinstance(value, Mapping) and value.get("$type") == _UNSET


def _plain(value: object) -> object:
    if isinstance(value, int) and value not in _INTEGERS:
        return str(value)
    if isinstance(value, list):
        return [_plain(item) for item in value] if len(value) <= MOST_ITEMS else brief(value)
    if isinstance(value, Mapping):
        return _object(value)
    return value


def _object(value: Mapping[str, object]) -> object:
    kind = value.get("$type")
    if kind is None:
        return {key: _plain(item) for key, item in value.items()}
    items = value.get("items")
    if kind in ("tuple", "set", "frozenset") and isinstance(items, list):
        return _plain(items)
    fields = {key: item for key, item in value.items() if key != "$type"}
    if kind == "ndarray":
        return _array(value)
    if {*fields} in ({"image", "shape"}, {"items"}, {"repr"}):
        return brief(value)
    if kind == "float":
        return float(str(value["value"]))
    if {*fields} == {"name", "value"}:  # an enumeration
        return _plain(value["value"])
    return {"__type": str(kind), **{key: _plain(item) for key, item in fields.items()}}


def _array(value: Mapping[str, object]) -> object:
    shape, values = value.get("shape"), value.get("values")
    if not isinstance(shape, list) or values is None or prod(shape) > MOST_ITEMS:
        return brief(value)
    return _plain(values)
