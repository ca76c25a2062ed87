"""Turns values of the blackboard into JSON that no later change can touch.

Plain JSON stays what it is; everything else becomes an object whose `$type` says what it
was. Images and large arrays are stored once on their own channels and referred to by number;
what is not stored is named by a hash. docs/recording.md lists the forms, and
`executive.engine.recording.decoding` reads them back.
"""

import base64
import dataclasses
import hashlib
import math
import re
from collections.abc import Callable, Mapping
from enum import Enum

import numpy as np
from numpy.typing import NDArray
from pydantic import JsonValue

StoreImage = Callable[[NDArray[np.uint8]], int | None]
"""Stores an image and answers with its number, None where it is left out."""

StoreArray = Callable[[NDArray[np.generic]], int | None]
"""Stores a large array and answers with its number, None where it is left out."""

INLINE_ELEMENTS = 8192
"""Arrays with more elements than this are not written out."""

_MEMORY_ADDRESS = re.compile(r" at 0x[0-9a-f]+")


class ValueEncoder:
    """Encodes values; images and large arrays go where they are stored."""

    def __init__(self, store_image: StoreImage, store_array: StoreArray = lambda _: None) -> None:
        """Remember where images and large arrays go."""
        self._store_image, self._store_array = store_image, store_array

    def encode(self, value: object) -> JsonValue:
        """Return the JSON form of a value."""
        if isinstance(value, Enum):
            return _typed(value, name=value.name, value=self.encode(value.value))
        if value is None or isinstance(value, bool | int | str):
            return value
        if isinstance(value, float):
            return _float(value)
        if isinstance(value, np.generic):
            return self.encode(value.item())
        if isinstance(value, np.ndarray):
            return self._array(value)
        return self._container(value)

    def _container(self, value: object) -> JsonValue:
        if dataclasses.is_dataclass(value) and not isinstance(value, type):
            fields = {
                field.name: self.encode(getattr(value, field.name))
                for field in dataclasses.fields(value)
            }
            return _typed(value, **fields)
        if isinstance(value, list):
            return [self.encode(item) for item in value]
        if isinstance(value, tuple):
            return _typed(value, items=[self.encode(item) for item in value])
        if isinstance(value, Mapping):
            return self._mapping(value)
        if isinstance(value, set | frozenset):
            return _typed(value, items=sorted((self.encode(item) for item in value), key=repr))
        if isinstance(value, bytes):
            return _typed(value, base64=base64.b64encode(value).decode())
        return _typed(value, repr=_MEMORY_ADDRESS.sub("", repr(value))[:1000])

    def _mapping(self, value: Mapping[object, object]) -> JsonValue:
        items = {key: self.encode(item) for key, item in value.items()}
        plain = {key: item for key, item in items.items() if isinstance(key, str)}
        if len(plain) == len(items) and not any(key.startswith("$") for key in plain):
            return plain
        return {"$type": "dict", "items": [[self.encode(key), item] for key, item in items.items()]}

    def _array(self, array: NDArray[np.generic]) -> JsonValue:
        if array.dtype == np.uint8 and _is_image(array.shape):
            number = self._store_image(np.asarray(array, np.uint8))
            shape: list[JsonValue] = list(array.shape)
            return {"$type": "image", **_reference("image", number, array), "shape": shape}
        form: dict[str, JsonValue] = {
            "$type": "ndarray",
            "dtype": array.dtype.name,
            "shape": list(array.shape),
        }
        if array.dtype.kind not in "biuf":
            return {**form, "hash": array_hash(array)}
        if array.size > INLINE_ELEMENTS:
            return {**form, **_reference("array", self._store_array(array), array)}
        return {**form, "values": _numbers(array.tolist())}


def _reference(
    channel: str, number: int | None, array: NDArray[np.generic]
) -> dict[str, JsonValue]:
    return {"hash": array_hash(array)} if number is None else {channel: number}


def array_hash(array: NDArray[np.generic]) -> str:
    """Return a short hash of an array's bytes, hexadecimal."""
    return hashlib.blake2b(np.ascontiguousarray(array).tobytes(), digest_size=8).hexdigest()


def _is_image(shape: tuple[int, ...]) -> bool:
    return len(shape) == 2 or (len(shape) == 3 and shape[2] == 3)


def _typed(value: object, /, **fields: JsonValue) -> JsonValue:
    kind = type(value)
    module = "" if kind.__module__ == "builtins" else f"{kind.__module__}."
    return {"$type": module + kind.__qualname__, **fields}


def _float(value: float) -> JsonValue:
    return value if math.isfinite(value) else {"$type": "float", "value": str(value)}


def _numbers(values: object) -> JsonValue:
    """Write numbers that JSON does not know (nan, inf) as words; `float` reads them back."""
    if isinstance(values, list):
        return [_numbers(item) for item in values]
    if isinstance(values, float) and not math.isfinite(values):
        return str(values)
    return values  # type: ignore[return-value]  # what ndarray.tolist() gives is bool, int or float
