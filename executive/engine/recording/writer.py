"""Writes a run to an MCAP file while it happens.

What a tick decided is on its way to the disk when the tick's record has been taken, so a
process that is killed loses at most the ticks of the last `FLUSH_S` seconds in which nothing
was decided: no leaf ended, no key was written, no node was halted or raised.
"""

import json
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Self

from mcap.records import Message, Schema
from mcap.writer import CompressionType, Writer
from pydantic import BaseModel, JsonValue

from executive.core.errors import RecordingError
from executive.core.outcome import Reason
from executive.core.world import StreamMessage
from executive.engine.blackboard import Write
from executive.engine.recording.large import LargeValues
from executive.engine.recording.messages import (
    KEYFRAME_EVERY,
    MISSION_TOPIC,
    RESULT_TOPIC,
    TICKS_TOPIC,
    Keyframe,
    MissionHeader,
    ResultMessage,
    TickMessage,
)
from executive.engine.recording.reader import Recording
from executive.engine.recording.values import ValueEncoder
from executive.engine.ticks import NodeOutcome, NodeStatus, Tick

FLUSH_S = 0.5
CHUNK_BYTES = 256 * 1024
IMAGES_PER_S = 30.0
"""Of each key, new images and large arrays go in at most this often [1/s]."""


class RecordingWriter:
    """One recording being written; an observer of a run.

    Raises:
        RecordingError: From any method, when the file cannot be written.
    """

    def __init__(
        self, path: Path, header: MissionHeader, *, images_per_s: float = IMAGES_PER_S
    ) -> None:
        """Create the file and write what is known before the first tick.

        Args:
            path: The file; its folder is made, and a file that is there is replaced.
            header: What is going to run.
            images_per_s: How often new images and large arrays of one key go in [1/s]; the
                others are named by hash.
        """
        self.path = path
        self._channels: dict[tuple[str, str], int] = {}
        self._schemas: dict[str, int] = {}
        self._large = LargeValues(self._write_large, images_per_s)
        self._encoder = ValueEncoder(self._large.image, self._large.array)
        self._statuses = [NodeStatus.INVALID] * len(header.nodes)
        self._written: dict[str, int] = {}
        self._ended: dict[int, int] = {}
        self._visited: tuple[int, ...] | None = None
        self._time_s, self._flushed_s = 0.0, time.monotonic()
        with self._guarded():
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = path.open("wb")
            self._mcap = Writer(
                self._file, chunk_size=CHUNK_BYTES, compression=CompressionType.ZSTD
            )
            self._mcap.start(profile="cellwright", library="cellwright")
            self._write_model(MISSION_TOPIC, header)
            self._flush()

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
            self._write_model(TICKS_TOPIC, self._tick_message(tick), sequence=tick.number)
            decided = tick.outcomes or tick.writes or tick.halts or tick.faults
            if decided or time.monotonic() - self._flushed_s > FLUSH_S:
                self._flush()

    def on_streams(self, messages: Sequence[StreamMessage]) -> None:
        """Write what the cell streamed."""
        with self._guarded():
            for message in messages:
                channel = self._channel(message.topic, message.schema, {"type": "object"})
                self._add(channel, message.data, message.time_s)

    def write_result(self, result: ResultMessage) -> None:
        """Write what the run came to."""
        with self._guarded():
            self._write_model(RESULT_TOPIC, result)

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
            self._write_model(topic, message, sequence=number)
            self._flush()

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
            self._flush()

    def _carry(self, schema: Schema, topic: str, message: Message) -> None:
        if topic == TICKS_TOPIC:
            self._follow(TickMessage.model_validate_json(message.data))
        large = self._large.carry(topic, message.sequence)
        if large:
            self._flush()
        channel = self._channel(topic, schema.name, json.loads(schema.data))
        self._mcap.add_message(
            channel, message.log_time, message.data, message.publish_time, message.sequence
        )
        if large:
            self._flush()

    def _follow(self, tick: TickMessage) -> None:
        """Take note of a tick that was written by an earlier writer."""
        for node, status in tick.changes:
            self._statuses[node] = status
        self._written.update((write.key, tick.tick) for write in tick.writes)
        self._ended.update((outcome.node, tick.tick) for outcome in tick.outcomes)
        self._visited = self._visited if tick.visited is None else tick.visited
        self._time_s = tick.time_s

    def close(self) -> None:
        """Write the index and close the file; closing twice does nothing."""
        if not self._file.closed:
            with self._guarded(), self._file:
                self._mcap.finish()

    def _tick_message(self, tick: Tick) -> TickMessage:
        for node, status in tick.changes:
            self._statuses[node] = status
        self._written.update((write.key, tick.number) for write in tick.writes)
        self._ended.update((outcome.node, tick.number) for outcome in tick.outcomes)
        keyframe = None
        if tick.number % KEYFRAME_EVERY == 0:
            keyframe = Keyframe(
                statuses=tuple(self._statuses), written=self._written, ended=self._ended
            )
        same = keyframe is None and tick.visited == self._visited
        self._visited = tick.visited
        return TickMessage(
            tick=tick.number,
            time_s=tick.time_s,
            duration_s=tick.duration_s,
            visited=None if same else tick.visited,
            changes=tick.changes,
            halts=tick.halts,
            outcomes=tuple(self._encoded_outcome(outcome) for outcome in tick.outcomes),
            writes=tuple(self._encoded_write(write) for write in tick.writes),
            faults=tick.faults,
            slow=tick.slow,
            keyframe=keyframe,
        )

    def _encoded_outcome(self, outcome: NodeOutcome) -> NodeOutcome:
        reason = outcome.reason
        if reason is None:
            return outcome
        self._large.begin(reason.code, self._time_s)
        data = {name: self._encoder.encode(value) for name, value in reason.data.items()}
        return replace(outcome, reason=Reason(reason.code, reason.text, data))

    def _encoded_write(self, write: Write) -> Write:
        self._large.begin(write.key, self._time_s)
        return replace(write, value=self._encoder.encode(write.value))

    def _write_large(
        self, topic: str, schema: str, definition: object, data: bytes, number: int
    ) -> None:
        # In a chunk of its own, so that a reader of ticks need not unpack it.
        self._flush()
        self._add(self._channel(topic, schema, definition), data, self._time_s, number)
        self._flush()

    def _write_model(self, topic: str, message: BaseModel, sequence: int = 0) -> None:
        name = type(message).__name__
        if (topic, name) not in self._channels:
            self._channel(topic, name, type(message).model_json_schema())
        data = message.model_dump_json(exclude_defaults=True).encode()
        self._add(self._channels[topic, name], data, self._time_s, sequence)

    def _channel(self, topic: str, schema: str, definition: object) -> int:
        if (topic, schema) not in self._channels:
            if schema not in self._schemas:
                text = json.dumps(definition).encode()
                self._schemas[schema] = self._mcap.register_schema(schema, "jsonschema", text)
            self._channels[topic, schema] = self._mcap.register_channel(
                topic, "json", self._schemas[schema]
            )
        return self._channels[topic, schema]

    def _add(self, channel: int, data: bytes, time_s: float, sequence: int = 0) -> None:
        stamp = _nanoseconds(time_s)
        self._mcap.add_message(channel, stamp, data, stamp, sequence)

    def _flush(self) -> None:
        self._mcap.flush()
        self._flushed_s = time.monotonic()

    @contextmanager
    def _guarded(self) -> Iterator[None]:
        try:
            yield
        except OSError as cause:
            raise RecordingError(
                f"{self.path}: cannot write the recording; got {cause}; "
                "try --record FILE in a folder with space and write permission"
            ) from cause


def _nanoseconds(time_s: float) -> int:
    return round(time_s * 1e9)
