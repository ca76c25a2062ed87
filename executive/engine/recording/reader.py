"""Reads a recording, also one whose writer was killed in the middle."""

import base64
import json
import struct
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import BinaryIO

import numpy as np
from mcap.exceptions import McapError
from mcap.reader import NonSeekingReader, SeekingReader
from mcap.records import Channel, Message, Schema
from numpy.typing import NDArray
from pydantic import ValidationError
from pydantic_core import from_json
from zstandard import ZstdError

from executive.core.errors import RecordingError
from executive.core.outcome import Reason
from executive.core.world import StreamMessage
from executive.engine.checkpoints.messages import CHECKPOINTS_TOPIC
from executive.engine.recording.large import array_of, image_of
from executive.engine.recording.messages import (
    ARRAYS_TOPIC,
    IMAGES_TOPIC,
    KEYFRAME_EVERY,
    MISSION_TOPIC,
    RESULT_TOPIC,
    TICKS_TOPIC,
    MissionHeader,
    ResultMessage,
    TickMessage,
)
from executive.engine.recording.parts import parts_of
from executive.engine.ticks import NodeOutcome, NodeStatus, Tick

_OWN_TOPICS = (MISSION_TOPIC, TICKS_TOPIC, RESULT_TOPIC)
BROKEN = (
    *(McapError, ZstdError, struct.error, EOFError),
    *(ValueError, KeyError, MemoryError, OverflowError),
)
"""What the MCAP library raises over bytes that are not as they were written."""

_Found = tuple[Schema | None, Channel, Message]


@dataclass(frozen=True, slots=True)
class KeyState:
    """What the blackboard holds under one key.

    Attributes:
        value: The value in its JSON form.
        writer: Path of the node that wrote it.
        tick: When it was written.
    """

    value: object
    writer: str
    tick: int


@dataclass(frozen=True, slots=True)
class RecordedImage:
    """An image that was on the blackboard.

    Attributes:
        number: What values refer to it by.
        time_s: When it was written, on the cell's clock [s].
        png: The image as a PNG file.
    """

    number: int
    time_s: float
    png: bytes


@dataclass(frozen=True, slots=True)
class Moves:
    """What a tick says about nodes, as it is stored.

    Attributes:
        visited: Nodes that were ticked; None where they are those of the tick before.
        changes: Node and new status of those whose status changed.
        halted: Nodes that were halted.
    """

    visited: Sequence[int] | None
    changes: Sequence[tuple[int, str]]
    halted: Sequence[int]


class Recording:
    """One recorded run, open for reading.

    Attributes:
        path: The file.
        header: What was run.
        result: What it came to; None when the writer was killed before the end.
        complete: Whether the file was closed; False after a kill.
    """

    def __init__(
        self,
        path: Path,
        header: MissionHeader,
        ticks: list[bytes],
        result: ResultMessage | None,
        complete: bool,
    ) -> None:
        """Hold what `open` has read."""
        self.path, self.header, self.result, self.complete = path, header, result, complete
        self._raw = ticks
        self._decoded: dict[int, TickMessage] = {}

    @classmethod
    def open(cls, path: Path) -> "Recording":
        """Read a recording; what a killed writer left behind is read as far as it goes.

        Raises:
            RecordingError: There is no such file, or it is no recording of ours.
        """
        found: dict[str, list[bytes]] = {topic: [] for topic in _OWN_TOPICS}
        reading = _Reading(path)
        in_order = True
        for _, channel, message in reading.messages(_OWN_TOPICS):
            messages = found[channel.topic]
            # A damaged index can shuffle chunks: what comes after a gap is not to be trusted.
            in_order &= channel.topic != TICKS_TOPIC or message.sequence == len(messages)
            if in_order:
                messages.append(message.data)
        if not found[MISSION_TOPIC]:
            raise _no_recording(path, "no /mission message")
        try:
            header = MissionHeader.model_validate_json(found[MISSION_TOPIC][0])
            results = [ResultMessage.model_validate_json(data) for data in found[RESULT_TOPIC]]
        except ValidationError as cause:
            raise _no_recording(path, str(cause.errors()[0]["msg"])) from cause
        return cls(
            path,
            header,
            found[TICKS_TOPIC],
            results[-1] if results else None,
            reading.complete and in_order,
        )

    def take(self, topic: str, number: int, data: bytes) -> bool:
        """Take in one more message of a run that goes on; return whether it was news."""
        if topic == TICKS_TOPIC and number == len(self._raw):
            self._raw.append(data)
            return True
        if topic == RESULT_TOPIC and self.result is None:
            self.result = ResultMessage.model_validate_json(data)
            return True
        return False

    def __len__(self) -> int:
        """Return the number of tick records, the runner's closing one included."""
        return len(self._raw)

    def ticks(self) -> Iterator[Tick]:
        """Return all ticks in order."""
        return (self.tick(number) for number in range(len(self)))

    def tick(self, number: int) -> Tick:
        """Return one tick; values are in their JSON form.

        Raises:
            RecordingError: There is no such tick.
        """
        message = self._message(number)
        visited, back = message.visited, number
        while visited is None:
            back -= 1
            visited = self._message(back).visited
        return Tick(
            number=message.tick,
            time_s=message.time_s,
            duration_s=message.duration_s,
            visited=visited,
            changes=message.changes,
            halts=message.halts,
            outcomes=message.outcomes,
            writes=message.writes,
            faults=message.faults,
            slow=message.slow,
        )

    def moves(self, number: int) -> Moves:
        """Return what a tick says about nodes, quicker than all of it is read."""
        message = from_json(self._raw[number])
        return Moves(
            message.get("visited"),
            message.get("changes", ()),
            [halt["node"] for halt in message.get("halts", ())],
        )

    def statuses(self, number: int) -> tuple[NodeStatus, ...]:
        """Return the status of every node after a tick, in the order of the node table."""
        statuses = [NodeStatus.INVALID] * len(self.header.nodes)
        for message in self._from_keyframe(number):
            if message.keyframe is not None:
                statuses = list(message.keyframe.statuses)
            for node, status in message.changes:
                statuses[node] = status
        return tuple(statuses)

    def blackboard(self, number: int) -> dict[str, KeyState]:
        """Return what the blackboard held after a tick, by key."""
        written: dict[str, int] = {}
        for message in self._from_keyframe(number):
            if message.keyframe is not None:
                written.update(message.keyframe.written)
            written.update((write.key, message.tick) for write in message.writes)
        return {key: self._key_state(key, tick) for key, tick in sorted(written.items())}

    def outcomes(self, number: int) -> dict[int, NodeOutcome]:
        """Return how each leaf ended last, up to a tick, by index."""
        ended: dict[int, int] = {}
        for message in self._from_keyframe(number):
            if message.keyframe is not None:
                ended.update(message.keyframe.ended)
            ended.update((outcome.node, message.tick) for outcome in message.outcomes)
        return {node: self._outcome(node, tick) for node, tick in sorted(ended.items())}

    def reasons(self, number: int) -> dict[int, Reason]:
        """Return why each leaf that ended in failure last did so, up to a tick, by index."""
        outcomes = self.outcomes(number)
        return {node: end.reason for node, end in outcomes.items() if end.reason is not None}

    def images(self) -> Iterator[RecordedImage]:
        """Return the images in the order in which they were written."""
        for _, _, message in _Reading(self.path).messages((IMAGES_TOPIC,)):
            png = base64.b64decode(json.loads(message.data)["data"])
            yield RecordedImage(message.sequence, message.log_time / 1e9, png)

    def image(self, number: int) -> NDArray[np.uint8]:
        """Return one image, shape (H, W) or (H, W, 3).

        Raises:
            RecordingError: There is no such image.
        """
        return image_of(self.png(number))

    def png(self, number: int) -> bytes:
        """Return one image as a PNG file.

        Raises:
            RecordingError: There is no such image.
        """
        return base64.b64decode(json.loads(self._large(IMAGES_TOPIC, number))["data"])

    def array(self, number: int) -> NDArray[np.generic]:
        """Return one large array.

        Raises:
            RecordingError: There is no such array.
        """
        return array_of(self._large(ARRAYS_TOPIC, number))

    def _large(self, topic: str, number: int) -> bytes:
        for _, _, message in _Reading(self.path).messages((topic,)):
            if message.sequence == number:
                return message.data
        raise RecordingError(f"{self.path}: {topic} has no message {number}")

    def messages(self, topic: str) -> Iterator[bytes]:
        """Return the messages of one channel as they are stored, in order."""
        return (message.data for _, _, message in _Reading(self.path).messages((topic,)))

    def in_file_order(self) -> Iterator[_Found]:
        """Return every message as it stands in the file, in the order of writing."""
        return _Reading(self.path).in_file_order()

    def streams(self) -> Iterator[StreamMessage]:
        """Return what the cell streamed, in the order of time."""
        for schema, channel, message in _Reading(self.path).messages(None):
            if channel.topic not in (*_OWN_TOPICS, IMAGES_TOPIC, ARRAYS_TOPIC, CHECKPOINTS_TOPIC):
                name = "" if schema is None else schema.name
                yield StreamMessage(channel.topic, name, message.log_time / 1e9, message.data)

    def _from_keyframe(self, number: int) -> Iterator[TickMessage]:
        first = number - number % KEYFRAME_EVERY
        return (self._message(back) for back in range(first, number + 1))

    def _key_state(self, key: str, tick: int) -> KeyState:
        write = next(w for w in reversed(self._message(tick).writes) if w.key == key)
        return KeyState(write.value, write.writer, tick)

    def _outcome(self, node: int, tick: int) -> NodeOutcome:
        return next(end for end in self._message(tick).outcomes if end.node == node)

    def _message(self, number: int) -> TickMessage:
        if not 0 <= number < len(self._raw):
            raise RecordingError(
                f"{self.path}: no tick {number}; expected 0 to {len(self._raw) - 1}"
            )
        if number not in self._decoded:
            try:
                self._decoded[number] = TickMessage.model_validate_json(self._raw[number])
            except ValidationError as cause:  # a killed writer's file has no checksums
                raise _no_recording(self.path, f"a damaged tick {number}") from cause
        return self._decoded[number]


class _Reading:
    """One pass over the files of a recording."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self.complete = False

    def messages(self, topics: Sequence[str] | None) -> Iterator[_Found]:
        """Return messages in file order, up to where a file is broken."""
        return self._up_to_the_break(partial(_messages_of, topics=topics))

    def in_file_order(self) -> Iterator[_Found]:
        """Return every message in the order of writing, up to where a file is broken."""
        return self._up_to_the_break(_one_after_another)

    def _up_to_the_break(self, read: Callable[[BinaryIO], Iterator[_Found]]) -> Iterator[_Found]:
        try:
            for path in parts_of(self._path):
                with path.open("rb") as file:
                    yield from read(file)
            self.complete = True
        except OSError as cause:
            raise _no_recording(self._path, cause.strerror or str(cause)) from cause
        except BROKEN:
            return


def _one_after_another(file: BinaryIO, topics: Sequence[str] | None = None) -> Iterator[_Found]:
    reader = NonSeekingReader(file, validate_crcs=True)
    return reader.iter_messages(topics, log_time_order=False)


def _messages_of(file: BinaryIO, topics: Sequence[str] | None) -> Iterator[_Found]:
    """Return messages with the help of the index, or one after another where there is none."""
    try:
        reader = SeekingReader(file, validate_crcs=True)
        summary = reader.get_summary()
        indexed = summary is not None and bool(summary.chunk_indexes)
    except BROKEN:
        indexed = False
    if indexed:
        # In the order of time, which is that of writing; without it all chunks would be
        # unpacked before the first message comes out.
        return reader.iter_messages(topics, log_time_order=True)
    file.seek(0)
    return _one_after_another(file, topics)


def _no_recording(path: Path, got: str) -> RecordingError:
    return RecordingError(
        f"{path}: not a readable recording; got {got}; expected an MCAP file written by "
        "cellwright run; try a file of the runs folder"
    )
