"""Messages over a stream socket, each with its length before it; sending never blocks."""

import select
import socket
import struct
import time
from contextlib import suppress
from types import TracebackType
from typing import Self

from robots.drivers.messages import Message, WireError, from_bytes, to_bytes

_LENGTH = struct.Struct("<I")
# A trajectory of a minute at 250 Hz is 5 MB.
LONGEST_MESSAGE = 64 << 20
# What a partner leaves unread for so long that this much waits for it, it will not read.
_MOST_WAITING = 2 * LONGEST_MESSAGE
_CHUNK = 1 << 16


class Wire:
    """One end of a connection."""

    def __init__(self, connected: socket.socket) -> None:
        """Take over a socket that is connected."""
        connected.setblocking(False)
        connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._socket = connected
        self._coming = bytearray()
        self._going = bytearray()

    @classmethod
    def connect(cls, host: str, port: int, timeout_s: float) -> Self:
        """Connect to a listening controller.

        Raises:
            WireError: There is none.
        """
        try:
            return cls(socket.create_connection((host, port), timeout_s))
        except OSError as cause:
            raise WireError(f"cannot connect to {host}:{port}: {cause}") from cause

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def fileno(self) -> int:
        """Return the file descriptor, to wait for."""
        return self._socket.fileno()

    def send(self, message: Message) -> None:
        """Send a message; what the socket does not take now goes with the next one.

        Raises:
            WireError: The connection is broken.
        """
        data = to_bytes(message)
        self._going += _LENGTH.pack(len(data)) + data
        if len(self._going) > _MOST_WAITING:
            raise WireError("the other end reads nothing")
        self._flush()

    def receive(self) -> list[Message]:
        """Return the messages that have come, without waiting for any.

        Raises:
            WireError: The connection is broken and everything that came has been read, or what
                came is no message.
        """
        self._flush()
        broken = self._take_in()
        messages = []
        while (data := self._next()) is not None:
            messages.append(from_bytes(data))
        if broken and not messages:
            raise WireError(broken)
        return messages

    def wait(self, timeout_s: float) -> bool:
        """Wait until something may have come, or return False after `timeout_s`."""
        end_s = time.monotonic() + timeout_s
        while True:
            left_s = max(0.0, end_s - time.monotonic())
            sending = [self] if self._going else []
            ready, free, _ = select.select([self], sending, [], left_s)
            if ready:
                return True
            if not free:
                return False
            self._flush()

    def close(self) -> None:
        """Close the connection; safe to call again."""
        with suppress(OSError):
            self._socket.close()

    def _flush(self) -> None:
        while self._going:
            try:
                sent = self._socket.send(self._going)
            except BlockingIOError:
                return
            except OSError as cause:
                raise WireError(str(cause)) from cause
            del self._going[:sent]

    def _take_in(self) -> str:
        """Read what has come; return why nothing more will, or an empty text."""
        while True:
            try:
                chunk = self._socket.recv(_CHUNK)
            except BlockingIOError:
                return ""
            except OSError as cause:
                return str(cause)
            if not chunk:
                return "the other end closed the connection"
            self._coming += chunk

    def _next(self) -> bytes | None:
        if len(self._coming) < _LENGTH.size:
            return None
        (length,) = _LENGTH.unpack_from(self._coming)
        if length > LONGEST_MESSAGE:
            raise WireError(f"got a message of {length} bytes; expected {LONGEST_MESSAGE} at most")
        end = _LENGTH.size + length
        if len(self._coming) < end:
            return None
        data = bytes(self._coming[_LENGTH.size : end])
        del self._coming[:end]
        return data
