"""Writes a run to an MCAP file while it happens.

What a tick did is with the operating system when its record has been taken, so a process that
is killed loses the tick in progress and nothing else.
"""

import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Self

from mcap.records import Message, Schema
from pydantic import BaseModel, JsonValue

from executive.core.errors import RecordingError
from executive.core.world import StreamMessage
from executive.engine.recording.large import LargeValues
from executive.engine.recording.messages import (
    MISSION_TOPIC,
    RESULT_TOPIC,
    TICKS_TOPIC,
    MissionHeader,
    ResultMessage,
    TickMessage,
    schema_of,
)
from executive.engine.recording.parts import Item, Parts
from executive.engine.recording.reader import Recording
from executive.engine.recording.tickjson import TickEncoder
from executive.engine.recording.values import ValueEncoder
from executive.engine.ticks import Tick

PART_BYTES = 1024**3
"""A file that has reached this size is followed by a next part."""

IMAGES_PER_S = 30.0
"""Of each key, new images and large arrays go in at most this often [1/s]."""


class RecordingWriter:
    """One recording being written; an observer of a run.

    Raises:
        RecordingError: From any method, when the file cannot be written.
    """

    def __init__(
        self,
        path: Path,
        header: MissionHeader,
        *,
        images_per_s: float = IMAGES_PER_S,
        part_bytes: int = PART_BYTES,
    ) -> None:
        """Create the file and write what is known before the first tick.

        Args:
            path: The file; its folder is made, and a file that is there is replaced.
            header: What is going to run.
            images_per_s: How often new images and large arrays of one key go in [1/s]; the
                others are named by hash.
            part_bytes: A file that has reached this size is followed by a next part; readers
                open the parts as one recording.
        """
        self.path = path
        self._time_s = 0.0
        self._large = LargeValues(self._write_large, images_per_s)
        self._encoder = ValueEncoder(self._large.image, self._large.array)
        self._ticks = TickEncoder(len(header.nodes), self._encoder, self._large)
        with self._guarded():
            self._parts = Parts(path, self._item(MISSION_TOPIC, header), part_bytes)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def on_tick(self, tick: Tick) -> None:
        """Write one tick, with the images that it put on the blackboard."""
        self._time_s = tick.time_s
        with self._guarded():
            if self._parts.go_on():
                self._ticks.keyframe_due = True
            data = self._ticks.encode(tick)
            define = partial(schema_of, TickMessage)
            self._add(TICKS_TOPIC, TickMessage.__name__, define, data, tick.number)
            self._parts.flush()

    def on_streams(self, messages: Sequence[StreamMessage]) -> None:
        """Write what the cell streamed."""
        with self._guarded():
            for each in messages:
                stamp = _nanoseconds(each.time_s)
                self._parts.add(Item(each.topic, each.schema, _any_object, each.data, stamp))
            self._parts.flush()

    def write_result(self, result: ResultMessage) -> None:
        """Write what the run came to."""
        with self._guarded():
            self._parts.add(self._item(RESULT_TOPIC, result))

    def encoded(self, key: str, value: object, time_s: float) -> JsonValue:
        """Return the JSON form of a value, with what is large stored under that key."""
        self._time_s = time_s
        with self._guarded():
            self._large.begin(key, time_s)
            return self._encoder.encode(value)

    def write_now(self, topic: str, message: BaseModel, time_s: float, number: int) -> None:
        """Write a message that a kill in the next moment does not take back."""
        self._time_s = time_s
        with self._guarded():
            self._parts.add(self._item(topic, message, number))
            self._parts.flush()

    def carry_over(self, earlier: Recording, topic: str, last: int) -> None:
        """Begin with all of an earlier recording of the same mission up to one message.

        Args:
            earlier: The recording.
            topic: Channel of that message.
            last: Its number.
        """
        with self._guarded():
            for schema, channel, message in earlier.in_file_order():
                if schema is not None and channel.topic != MISSION_TOPIC:
                    self._carry(schema, channel.topic, message)
                if (channel.topic, message.sequence) == (topic, last):
                    break
            self._parts.flush()

    def _carry(self, schema: Schema, topic: str, message: Message) -> None:
        if topic == TICKS_TOPIC:
            tick = TickMessage.model_validate_json(message.data)
            self._ticks.follow(tick)
            self._time_s = tick.time_s
        self._large.carry(topic, message.sequence, message.data)
        self._parts.add(
            Item(
                topic,
                schema.name,
                lambda: json.loads(schema.data),
                message.data,
                message.log_time,
                message.sequence,
            )
        )

    def close(self) -> None:
        """Write the index and close the file; closing twice does nothing."""
        if not self._parts.closed:
            with self._guarded():
                self._parts.close()

    def _write_large(
        self, topic: str, schema: str, definition: object, data: bytes, number: int
    ) -> None:
        self._add(topic, schema, lambda: definition, data, number)

    def _add(
        self, topic: str, schema: str, define: Callable[[], object], data: bytes, number: int
    ) -> None:
        self._parts.add(Item(topic, schema, define, data, _nanoseconds(self._time_s), number))

    def _item(self, topic: str, message: BaseModel, number: int = 0) -> Item:
        kind = type(message)
        data = message.model_dump_json(exclude_defaults=True).encode()
        stamp = _nanoseconds(self._time_s)
        return Item(topic, kind.__name__, partial(schema_of, kind), data, stamp, number)

    @contextmanager
    def _guarded(self) -> Iterator[None]:
        try:
            yield
        except OSError as cause:
            raise RecordingError(
                f"{self.path}: cannot write the recording; got {cause}; "
                "try --record FILE in a folder with space and write permission"
            ) from cause


def _any_object() -> object:
    return {"type": "object"}


def _nanoseconds(time_s: float) -> int:
    return round(time_s * 1e9)
