"""Recorded values as expressions see them: fields by name, enums as their text.

The JSON forms are those of docs/recording.md. What a recording does not hold (methods,
properties, large arrays) is not there either.
"""

from collections.abc import Mapping
from types import SimpleNamespace

import numpy as np


def opened(value: object) -> object:
    """Return a recorded value with its fields as attributes."""
    if isinstance(value, list):
        return [opened(item) for item in value]
    if not isinstance(value, Mapping):
        return value
    kind = value.get("$type")
    if kind is None:
        return {key: opened(item) for key, item in value.items()}
    return _typed(str(kind), value)


def _typed(kind: str, value: Mapping[str, object]) -> object:
    items = value.get("items")
    if kind in ("tuple", "set", "frozenset", "dict") and isinstance(items, list):
        if kind == "dict":
            return {opened(key): opened(item) for key, item in items}
        return tuple(opened(item) for item in items)
    if kind == "float":
        return float(str(value["value"]))
    if kind == "ndarray" and "values" in value:
        return np.array(value["values"], dtype=str(value["dtype"]))
    if {*value} == {"$type", "name", "value"}:  # an enumeration
        return opened(value["value"])
    fields = {key: opened(item) for key, item in value.items() if key != "$type"}
    return SimpleNamespace(**fields)
