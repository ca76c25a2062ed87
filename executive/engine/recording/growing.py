"""Follows a recording while it is written: only what is new is read.

A live recording has its messages one by one (see `parts`), so new ones can be read from where
the last one ended. When the writer closes a file it puts a packed one in its place, and a
recording that has grown too large goes on in a next part; both are seen by what stands in the
file's place, and everything is read anew then.
"""

import io
import struct
from collections.abc import Iterator
from pathlib import Path

from mcap.records import Channel, Message
from mcap.stream_reader import StreamReader

from executive.core.errors import RecordingError
from executive.engine.recording.parts import parts_of
from executive.engine.recording.reader import BROKEN, Recording

_MAGIC_BYTES = 8
_HEAD = struct.Struct("<BQ")


class GrowingRecording:
    """A recording that may still be written.

    Attributes:
        recording: The recording as far as it has been read.
    """

    def __init__(self, path: Path) -> None:
        """Open it.

        Raises:
            RecordingError: It cannot be read.
        """
        self.path = path
        self._place = self._where()
        self.recording = Recording.open(path)
        self._topics: dict[int, str] = {}
        self._read = _MAGIC_BYTES
        if not self.recording.complete and len(self._place[0]) == 1:
            self._take_new()

    def refresh(self) -> bool:
        """Read what has been written since; return whether there was anything."""
        place = self._where()
        if place == self._place:
            return False
        replaced = place[0] != self._place[0]
        self._place = place
        if replaced or self.recording.complete:
            self.recording = Recording.open(self.path)
            return True
        return self._take_new() > 0

    def _where(self) -> tuple[tuple[int, ...], int]:
        """Return the identities of the files, and the size of the last one."""
        try:
            found = [part.stat() for part in parts_of(self.path)]
        except OSError as cause:
            raise RecordingError(f"{self.path}: cannot be read: {cause.strerror}") from cause
        return tuple(one.st_ino for one in found), found[-1].st_size

    def _take_new(self) -> int:
        if len(self._place[0]) > 1:  # rare, and then large: the first parts do not change
            before = len(self.recording)
            self.recording = Recording.open(self.path)
            return len(self.recording) - before
        return sum([self.recording.take(*message) for message in self._new_messages()])

    def _new_messages(self) -> Iterator[tuple[str, int, bytes]]:
        with self.path.open("rb") as file:
            file.seek(self._read)
            new = file.read()
        whole = _whole_records(new)
        self._read += whole
        try:
            for record in StreamReader(io.BytesIO(new[:whole]), skip_magic=True).records:
                if isinstance(record, Channel):
                    self._topics[record.id] = record.topic
                elif isinstance(record, Message):
                    yield self._topics[record.channel_id], record.sequence, record.data
        except BROKEN:
            return


def _whole_records(data: bytes) -> int:
    """Return how many bytes belong to records that have been written to their end."""
    at = 0
    while at + _HEAD.size <= len(data):
        _, length = _HEAD.unpack_from(data, at)
        if at + _HEAD.size + length > len(data):
            break
        at += _HEAD.size + length
    return at
