"""Turns the JSON forms of values back into the objects that they were.

Only dataclasses, enumerations and named tuples of this project, and classes that the caller
registers, are built again: a recording is a file from outside and must not choose what is
imported. What a recording only describes (a `repr`, the hash of an array that was left out)
cannot come back, and that is said.
"""

import base64
import dataclasses
import importlib
from collections.abc import Callable, Iterable, Mapping
from enum import Enum
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from pydantic import JsonValue

from executive.core.errors import RecordingError

PACKAGES = ("executive", "perception", "robots", "simulation", "skills")
"""Packages whose classes a recording may name."""

Form = Mapping[str, Any]


class Stored(Protocol):
    """Gives what values refer to by number; an open `Recording` does."""

    def image(self, number: int) -> NDArray[np.uint8]:
        """Return an image, shape (H, W) or (H, W, 3)."""
        ...

    def array(self, number: int) -> NDArray[np.generic]:
        """Return a large array."""
        ...


def decode(value: JsonValue, load: Stored, classes: Iterable[type] = ()) -> object:
    """Return the object that a JSON form stands for.

    Mappings come back as dicts, numpy scalars as Python's.

    Args:
        value: As `ValueEncoder` made it.
        load: Where images and large arrays are.
        classes: Classes to be built beside those of this project, such as port types.

    Raises:
        RecordingError: The form names a class that is not allowed, or the value was not kept.
    """
    return _Decoder(load, {_full_name(kind): kind for kind in classes}).decode(value)


class _Decoder:
    def __init__(self, load: Stored, classes: Mapping[str, type]) -> None:
        self._load, self._classes = load, classes
        self._forms: Mapping[str, Callable[[Form], object]] = {
            "tuple": lambda form: tuple(self._items(form)),
            "set": lambda form: set(self._items(form)),
            "frozenset": lambda form: frozenset(self._items(form)),
            "dict": lambda form: {self.decode(k): self.decode(v) for k, v in form["items"]},
            "float": lambda form: float(form["value"]),
            "bytes": lambda form: base64.b64decode(form["base64"], validate=True),
            "image": self._image,
            "ndarray": self._array,
        }

    def decode(self, value: object) -> object:
        if isinstance(value, list | tuple):
            return [self.decode(item) for item in value]
        if not isinstance(value, Mapping):
            return value
        if "$type" not in value:
            return {key: self.decode(item) for key, item in value.items()}
        try:
            form = self._forms.get(value["$type"])
            return self._instance(value) if form is None else form(value)
        except (AttributeError, KeyError, TypeError, ValueError) as cause:
            raise RecordingError(
                f"a value of type {value['$type']!r} cannot be read back; got "
                f"{type(cause).__name__}: {cause}; expected what this version writes"
            ) from cause

    def _items(self, form: Form) -> list[object]:
        return [self.decode(item) for item in form["items"]]

    def _image(self, form: Form) -> object:
        if "image" not in form:
            raise _not_kept(form)
        return self._load.image(form["image"]).reshape(form["shape"])

    def _array(self, form: Form) -> object:
        if "values" in form:
            return np.array(form["values"], dtype=form["dtype"]).reshape(form["shape"])
        if "array" not in form:
            raise _not_kept(form)
        return self._load.array(form["array"])

    def _instance(self, form: Form) -> object:
        if "repr" in form and len(form) == 2:
            raise _not_kept(form)
        kind = self._class(form["$type"])
        if issubclass(kind, Enum):
            known = form["name"] in kind.__members__
            return kind[form["name"]] if known else kind(self.decode(form["value"]))
        if issubclass(kind, tuple):
            return kind(*self._items(form))
        fields = [field.name for field in dataclasses.fields(kind) if field.init]
        return kind(**{name: self.decode(form[name]) for name in fields})

    def _class(self, name: str) -> Any:
        kind = self._classes.get(name) or _own_class(name)
        if not (dataclasses.is_dataclass(kind) or issubclass(kind, Enum | tuple)):
            raise _not_allowed(name)
        return kind


def _own_class(name: str) -> type:
    """Import a class of this project.

    Raises:
        RecordingError: It is of another package, or there is no such class.
    """
    parts = name.split(".")
    if parts[0] not in PACKAGES:
        raise _not_allowed(name)
    for length in range(len(parts) - 1, 0, -1):
        module_name = ".".join(parts[:length])
        try:
            found: Any = importlib.import_module(module_name)
        except ModuleNotFoundError as error:
            if not module_name.startswith(error.name or ""):
                raise
            continue
        for part in parts[length:]:
            found = getattr(found, part, None)
        # Not a name that the module only imports: that may be anything.
        if isinstance(found, type) and _full_name(found) == name:
            return found
        break
    raise _not_allowed(name)


def _full_name(kind: type) -> str:
    return f"{kind.__module__}.{kind.__qualname__}"


def _not_allowed(name: str) -> RecordingError:
    return RecordingError(
        f"a value of type {name!r} cannot be read back; expected a dataclass, an enumeration "
        f"or a named tuple of {', '.join(PACKAGES)}, or a registered port type"
    )


def _not_kept(form: Form) -> RecordingError:
    kept = form.get("repr") or f"hash {form.get('hash')}"
    return RecordingError(
        f"a value of type {form['$type']!r} was not kept in the recording; got only {kept}; "
        "try a run without a limit on images, or a type that recordings keep"
    )
