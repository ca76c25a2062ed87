"""Images and large arrays of a recording: each is stored once and referred to by number.

How many go in is limited key by key on the cell's clock, so that two runs with one seed keep
the same ones.
"""

import base64
import io
import json
from collections.abc import Callable

import numpy as np
import zstandard
from numpy.typing import NDArray

from executive.engine.recording.messages import (
    ARRAYS_TOPIC,
    COMPRESSED_IMAGE_SCHEMA,
    IMAGES_TOPIC,
    ArrayMessage,
)
from executive.engine.recording.values import array_hash

WriteLarge = Callable[[str, str, object, bytes, int], None]
"""Writes a message: topic, name of the schema, schema, data, number."""

Array = NDArray[np.generic]


class LargeValues:
    """Stores what is new, within the limit, and answers with numbers."""

    def __init__(self, write: WriteLarge, per_s: float) -> None:
        """Begin with nothing stored.

        Args:
            write: Where messages go.
            per_s: How often new images and arrays of one key are stored [1/s].
        """
        self._write, self._period_s = write, 1.0 / per_s
        self._numbers: dict[str, dict[tuple[object, ...], int]] = {
            IMAGES_TOPIC: {},
            ARRAYS_TOPIC: {},
        }
        self._stored_s: dict[str, float] = {}
        self._key, self._time_s = "", 0.0

    def begin(self, key: str, time_s: float) -> None:
        """Say which key the next images and arrays belong to, and when they were written."""
        self._key, self._time_s = key, time_s

    def image(self, image: NDArray[np.uint8]) -> int | None:
        """Return the number of an image, None where it is left out."""
        return self._number(IMAGES_TOPIC, image)

    def array(self, array: Array) -> int | None:
        """Return the number of an array, None where it is left out."""
        return self._number(ARRAYS_TOPIC, array)

    def carry(self, topic: str, number: int, message: bytes) -> None:
        """Take note of a message of an earlier recording, so that it is not stored again."""
        if topic == IMAGES_TOPIC:
            image = image_of(base64.b64decode(json.loads(message)["data"]))
            self._numbers[topic][_content(image)] = number
        elif topic == ARRAYS_TOPIC:
            self._numbers[topic][_content(array_of(message))] = number

    def _number(self, topic: str, array: Array) -> int | None:
        numbers = self._numbers[topic]
        content = _content(array)
        if content not in numbers:
            if not self._allowed():
                return None
            numbers[content] = len(numbers)
            self._store(topic, array, numbers[content])
        return numbers[content]

    def _allowed(self) -> bool:
        """Return whether the limit lets something new in; all of one write goes together."""
        last_s = self._stored_s.get(self._key)
        # Half a nanosecond of slack: times of ticks are sums of binary fractions.
        soon = last_s is not None and 0.0 < self._time_s - last_s < self._period_s - 5e-10
        if not soon:
            self._stored_s[self._key] = self._time_s
        return not soon

    def _store(self, topic: str, array: Array, number: int) -> None:
        if topic == ARRAYS_TOPIC:
            schema = ArrayMessage.model_json_schema()
            self._write(topic, ArrayMessage.__name__, schema, _array_message(array), number)
            return
        data = _image_message(array, self._time_s)
        self._write(topic, "foxglove.CompressedImage", COMPRESSED_IMAGE_SCHEMA, data, number)


def _content(array: Array) -> tuple[object, ...]:
    return array.dtype.name, array.shape, array_hash(array)


def array_of(message: bytes) -> Array:
    """Return the array of a message of `/arrays`."""
    stored = ArrayMessage.model_validate_json(message)
    raw = zstandard.ZstdDecompressor().decompress(base64.b64decode(stored.data))
    dtype = np.dtype(stored.dtype).newbyteorder("<")
    return np.frombuffer(raw, dtype).astype(stored.dtype).reshape(stored.shape)


def image_of(png: bytes) -> NDArray[np.uint8]:
    """Return the pixels of a PNG file, shape (H, W) or (H, W, 3)."""
    from PIL import Image

    return np.asarray(Image.open(io.BytesIO(png)), np.uint8)


def _array_message(array: Array) -> bytes:
    raw = np.ascontiguousarray(array, array.dtype.newbyteorder("<")).tobytes()
    message = ArrayMessage(
        dtype=array.dtype.name,
        shape=array.shape,
        data=base64.b64encode(zstandard.ZstdCompressor(level=1).compress(raw)).decode(),
    )
    return message.model_dump_json().encode()


def _image_message(image: Array, time_s: float) -> bytes:
    seconds, nanoseconds = divmod(round(time_s * 1e9), 10**9)
    message = {
        "timestamp": {"sec": seconds, "nsec": nanoseconds},
        "frame_id": "",
        "format": "png",
        "data": base64.b64encode(_png(image)).decode(),
    }
    return json.dumps(message).encode()


def _png(image: Array) -> bytes:
    from PIL import Image

    buffer = io.BytesIO()
    # Camera noise does not compress: more effort costs time and gains nothing.
    Image.fromarray(image).save(buffer, "PNG", compress_level=1)
    return buffer.getvalue()
