"""The keys that a program writes, with their types, before anything runs."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Any

from executive.core.errors import Fault, InputError
from executive.core.registry import closest
from executive.engine.language.fitting import check, fit
from executive.engine.language.porttypes import accepts, type_name
from executive.engine.loading.keys import KeyTable
from executive.engine.loading.loader import Program
from executive.engine.loading.nodeports import PortTable
from executive.engine.loading.wiring import wire


@dataclass(frozen=True, slots=True)
class KnownKey:
    """A key of one tree of a program.

    Attributes:
        tree: The tree.
        name: Name of the key in it.
        type: Its type.
    """

    tree: str
    name: str
    type: Any


@dataclass(frozen=True, slots=True)
class WrongValue:
    """A value that a key may have, fitted to its type; NaN stands for one of the right shape."""

    type: Any
    value: object


def known_keys(program: Program) -> Iterator[KnownKey]:
    """Return the keys that the nodes of a program write, tree by tree."""
    ports = PortTable(program.skills, program.subtrees)
    faults: list[Fault] = []  # a checked program has none
    for tree in (program.tree, *program.subtrees.values()):
        wirings = {node: wire(node, ports, faults) for node in tree.root.walk()}
        keys = KeyTable(tree, wirings)
        for name in keys.writers:
            yield KnownKey(tree.name, name, keys.types[name])


def keys_meant(pattern: str, known: list[KnownKey]) -> list[KnownKey]:
    """Return the keys that a pattern means: a name, a full key, or a glob of these.

    Raises:
        InputError: It means none.
    """
    name = pattern.rpartition(":")[2]
    found = [key for key in known if fnmatchcase(key.name, name)]
    if not found:
        raise InputError(f"no key {name!r}; {closest(name, sorted({key.name for key in known}))}")
    return found


def wrong_values(value: object, keys: list[KnownKey]) -> list[WrongValue]:
    """Return a value as each of the types that some keys have.

    Raises:
        InputError: It is of another type; names the key and the type.
    """
    return [WrongValue(key.type, _fitted(value, key)) for key in keys]


def _fitted(value: object, key: KnownKey) -> object:
    if isinstance(value, float) and math.isnan(value):
        if not accepts(key.type, float) and not _is_array(key.type):
            raise InputError(
                f"key {key.name!r} of {key.tree}: expected {type_name(key.type)}, got nan; "
                "nan is for numbers with a point, and for arrays"
            )
        return value
    try:
        return fit(value, key.type)
    except ValueError as error:
        raise InputError(f"key {key.name!r} of {key.tree}: {error}") from None


def _is_array(kind: Any) -> bool:
    return str(getattr(kind, "__module__", "")).partition(".")[0] == "numpy"


def instead_of(written: object, values: list[WrongValue]) -> object:
    """Return the wrong value that stands in for a right one, which tells the type."""
    chosen = next((one for one in values if _is_of(written, one.type)), values[0])
    if isinstance(chosen.value, float) and math.isnan(chosen.value):
        return _nan_like(written)
    return chosen.value


def _is_of(value: object, kind: Any) -> bool:
    try:
        check(value, kind)
    except ValueError:
        return False
    return True


def _nan_like(written: object) -> object:
    import numpy as np  # not needed to read faults

    if isinstance(written, np.ndarray) and written.ndim:
        return np.full(written.shape, math.nan)
    return math.nan
