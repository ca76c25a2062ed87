"""The files of a recording: one MCAP file, and further parts when it grows too large.

While a run goes on, messages stand in the file one by one, so that each is with the operating
system as soon as it is flushed, and any MCAP reader can read what a killed process left. When
it is closed, the file is written once more with compressed chunks and an index, which makes it
several times smaller and quick to seek in; until that is complete, the first file stays.
"""

import json
from collections.abc import Callable, Iterator
from contextlib import closing, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from mcap.reader import NonSeekingReader
from mcap.writer import CompressionType, Writer

from executive.engine.recording.messages import ARRAYS_TOPIC, IMAGES_TOPIC, MISSION_TOPIC

CHUNK_BYTES = 32 * 1024
"""Of messages; damage inside a file costs a chunk, some hundred ticks."""

MESSAGE_OVERHEAD_BYTES = 31
_ALONE = (ARRAYS_TOPIC, IMAGES_TOPIC, MISSION_TOPIC)


@dataclass(frozen=True, slots=True)
class Item:
    """One message.

    Attributes:
        topic: Its channel.
        schema: Name of its schema.
        define: Returns the JSON schema; asked once a file.
        data: The message.
        time_ns: When it was written, on the cell's clock [ns].
        sequence: Its number.
    """

    topic: str
    schema: str
    define: Callable[[], object]
    data: bytes
    time_ns: int
    sequence: int = 0


class McapFile:
    """An MCAP file with JSON channels that are made as they are needed."""

    def __init__(self, path: Path, *, indexed: bool) -> None:
        """Create the file.

        Args:
            path: The file; one that is there is replaced.
            indexed: Whether messages go into chunks with an index.
        """
        self.path, self.bytes = path, 0
        self._file = path.open("wb")
        self._mcap = Writer(
            self._file,
            chunk_size=CHUNK_BYTES,
            compression=CompressionType.ZSTD,
            use_chunking=indexed,
        )
        self._mcap.start(profile="cellwright", library="cellwright")
        self._channels: dict[tuple[str, str], int] = {}
        self._schemas: dict[str, int] = {}

    def add(self, item: Item) -> None:
        """Add a message."""
        channel = self._channels.get((item.topic, item.schema)) or self._channel(item)
        self._mcap.add_message(channel, item.time_ns, item.data, item.time_ns, item.sequence)
        self.bytes += len(item.data) + MESSAGE_OVERHEAD_BYTES

    def flush(self) -> None:
        """Hand everything to the operating system."""
        self._mcap.flush()

    def finish(self) -> None:
        """Write what belongs at the end, and close the file."""
        with self._file:
            self._mcap.finish()

    def close(self) -> None:
        """Close the file as it is."""
        self._file.close()

    @property
    def closed(self) -> bool:
        """Whether it was closed."""
        return self._file.closed

    def _channel(self, item: Item) -> int:
        if item.schema not in self._schemas:
            text = json.dumps(item.define()).encode()
            self._schemas[item.schema] = self._mcap.register_schema(item.schema, "jsonschema", text)
        schema = self._schemas[item.schema]
        channel: int = self._mcap.register_channel(item.topic, "json", schema)
        self._channels[item.topic, item.schema] = channel
        return channel


class Parts:
    """Writes messages to a file, and goes on in a next one when it is full."""

    def __init__(self, path: Path, first: Item, part_bytes: int) -> None:
        """Create the first file and write what each of them begins with.

        Args:
            path: The first file; its folder is made, earlier files of its name are replaced.
            first: The first message of every part.
            part_bytes: A part that has reached this size is closed.
        """
        path.parent.mkdir(parents=True, exist_ok=True)
        parts = parts_of(path)
        for stale in (*parts[1:], *map(_packing_path, parts)):
            stale.unlink(missing_ok=True)
        self._path, self._first, self._limit = path, first, part_bytes
        self._closed: list[Path] = []
        self._part = self._begin(path)

    @property
    def closed(self) -> bool:
        """Whether the last part was closed."""
        return self._part.closed

    def add(self, item: Item) -> None:
        """Add a message to the last part."""
        self._part.add(item)

    def flush(self) -> None:
        """Hand everything to the operating system."""
        self._part.flush()

    def go_on(self) -> bool:
        """Begin a new part if this one is full; return whether that was so."""
        if self._part.bytes < self._limit:
            return False
        self._part.finish()
        self._closed.append(self._part.path)
        self._part = self._begin(part_path(self._path, len(self._closed) + 1))
        return True

    def close(self) -> None:
        """Close the last part, and give all parts their index."""
        self._part.finish()
        for path in (*self._closed, self._part.path):
            compact(path)

    def _begin(self, path: Path) -> McapFile:
        part = McapFile(path, indexed=False)
        part.add(self._first)
        part.flush()
        return part


def part_path(path: Path, number: int) -> Path:
    """Return the file of a part, counted from 1."""
    return path if number == 1 else path.with_name(f"{path.stem}.part{number}{path.suffix}")


def parts_of(path: Path) -> list[Path]:
    """Return the files of a recording in order, given any of them; the first need not exist."""
    stem, part, _ = path.stem.rpartition(".part")
    if part and (first := path.with_name(f"{stem}{path.suffix}")).exists():
        path = first
    found, number = [path], 2
    while part_path(path, number).exists():
        found.append(part_path(path, number))
        number += 1
    return found


def _packing_path(path: Path) -> Path:
    """Return the file that a part is packed into; a kill meanwhile leaves it behind."""
    return path.with_name(f"{path.name}.packing")


def compact(path: Path) -> None:
    """Write a closed file once more, with compressed chunks and an index.

    Without room for that, the file stays as it is: it is complete.
    """
    packed_path = _packing_path(path)
    try:
        _pack(path, packed_path)
        packed_path.replace(path)
    except OSError:
        with suppress(OSError):
            packed_path.unlink(missing_ok=True)


def _pack(source: Path, target: Path) -> None:
    with closing(McapFile(target, indexed=True)) as packed:
        for item in _items(source):
            # In chunks of their own, so that a reader of ticks need not unpack them.
            if item.topic in _ALONE:
                packed.flush()
            packed.add(item)
            if item.topic in _ALONE:
                packed.flush()
        packed.finish()


def _items(path: Path) -> Iterator[Item]:
    with path.open("rb") as file:
        reader = NonSeekingReader(file)
        for schema, channel, message in reader.iter_messages(log_time_order=False):
            define = partial(json.loads, schema.data)
            stamp, number = message.log_time, message.sequence
            yield Item(channel.topic, schema.name, define, message.data, stamp, number)
