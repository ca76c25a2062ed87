"""Commands to a running mission from another process on the same machine.

The process that runs a mission listens on a Unix socket that belongs to the recording; who
knows the recording finds the socket. A message is one line of JSON, and so is the answer:

    {"command": "pause", "by": "terminal"}  ->  {"ok": true, "answer": {...}}
    {"command": "walk"}                     ->  {"ok": false, "error": "unknown command ..."}

The folder of the sockets can be entered by its user alone, so nobody else can command a cell.
"""

import hashlib
import json
import os
import socket
import socketserver
import stat
import tempfile
import threading
from collections.abc import Callable, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from executive.core.errors import CellwrightError, InputError
from executive.core.registry import closest

Arguments = Mapping[str, Any]
Command = Callable[[Arguments], object]

LONGEST_LINE = 64 * 1024
CLIENT_TIMEOUT_S = 5.0


class NotRunningError(InputError):
    """No process that runs this mission listens."""


def socket_path(recording: Path) -> Path:
    """Return the socket of a recording; its folder is made, for this user alone.

    Raises:
        InputError: The folder belongs to somebody else.
    """
    # A hash, because the path of a socket may be about 100 bytes long and no longer.
    name = hashlib.sha256(str(recording.resolve()).encode()).hexdigest()[:24]
    return runtime_folder() / f"{name}.sock"


def runtime_folder() -> Path:
    """Return the folder of what lives as long as a process; it is made, for this user alone.

    Raises:
        InputError: The folder belongs to somebody else.
    """
    folder = Path(tempfile.gettempdir()) / f"cellwright-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    status = folder.lstat()
    if status.st_uid != os.getuid() or not stat.S_ISDIR(status.st_mode) or status.st_mode & 0o077:
        raise InputError(
            f"{folder}: commands to a cell go through this folder; expected a folder that only "
            "this user may enter; try removing it"
        )
    return folder


class CommandServer:
    """Listens for commands in a thread of its own while the block lasts."""

    def __init__(self, recording: Path, commands: Mapping[str, Command]) -> None:
        """Offer commands by name; each is called in the server's thread with its arguments."""
        self._path = socket_path(recording)
        self._commands = dict(commands)

    def __enter__(self) -> Self:
        self._path.unlink(missing_ok=True)  # left behind by a process that was killed
        self._server = _Server(str(self._path), _Handler)
        self._server.answer = self._answer
        self._thread = threading.Thread(
            target=self._server.serve_forever, kwargs={"poll_interval": 0.1}, daemon=True
        )
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()
        self._path.unlink(missing_ok=True)

    def _answer(self, line: bytes) -> dict[str, object]:
        try:
            return {"ok": True, "answer": self._done(line)}
        except CellwrightError as error:
            return {"ok": False, "error": str(error)}
        except Exception as error:  # a command that breaks must not end the server
            return {"ok": False, "error": f"{type(error).__name__}: {error}"}

    def _done(self, line: bytes) -> object:
        try:
            message = json.loads(line)
        except ValueError as error:
            raise InputError(f"no JSON: {error}") from None
        name = message.pop("command", None) if isinstance(message, dict) else None
        if not isinstance(name, str):
            raise InputError('expected {"command": NAME, ...}')
        if name not in self._commands:
            raise InputError(f"unknown command {name!r}; {closest(name, [*self._commands])}")
        return self._commands[name](message)


class _Server(socketserver.ThreadingUnixStreamServer):
    daemon_threads = True
    answer: Callable[[bytes], dict[str, object]]


class _Handler(socketserver.StreamRequestHandler):
    server: _Server

    def handle(self) -> None:
        while line := self.rfile.readline(LONGEST_LINE):
            answer = json.dumps(self.server.answer(line)).encode() + b"\n"
            try:
                self.wfile.write(answer)
            except OSError:  # the client has gone
                return


def send(recording: Path, command: str, **arguments: object) -> Any:
    """Send one command to the process that writes a recording, and return its answer.

    Args:
        recording: The recording.
        command: Name of the command.
        **arguments: What goes with it; JSON values.

    Raises:
        NotRunningError: No process listens: the mission has ended.
        InputError: The command was refused.
    """
    message = json.dumps({"command": command, **arguments}).encode() + b"\n"
    try:
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as connection:
            connection.settimeout(CLIENT_TIMEOUT_S)
            connection.connect(str(socket_path(recording)))
            connection.sendall(message)
            with connection.makefile("rb") as lines:
                line = lines.readline()
    except OSError as error:
        raise NotRunningError(f"{recording}: no running mission answers; got {error}") from None
    if not line:
        raise NotRunningError(f"{recording}: the mission has ended")
    answer = json.loads(line)
    if not answer["ok"]:
        raise InputError(answer["error"])
    return answer["answer"]
