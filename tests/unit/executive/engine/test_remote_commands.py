"""Commands reach the process that writes a recording, and nothing else does harm there."""

import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from executive.core.errors import InputError
from executive.engine.running.remote import CommandServer, NotRunningError, send, socket_path


@pytest.fixture
def recording(tmp_path: Path) -> Iterator[Path]:
    """Return a recording whose process answers `double` and breaks on `broken`."""
    path = tmp_path / "run.mcap"
    commands = {"double": lambda arguments: 2 * arguments["value"], "broken": lambda _: 1 // 0}
    with CommandServer(path, commands):
        yield path


def test_a_command_is_answered(recording: Path) -> None:
    assert send(recording, "double", value=4) == 8


def test_an_unknown_command_is_answered_with_the_closest(recording: Path) -> None:
    with pytest.raises(InputError, match="did you mean 'double'"):
        send(recording, "doubel")


def test_a_command_that_breaks_does_not_end_the_server(recording: Path) -> None:
    with pytest.raises(InputError, match="ZeroDivisionError"):
        send(recording, "broken")
    assert send(recording, "double", value=1) == 2


@pytest.mark.parametrize("garbage", [b"\n", b"nonsense\n", b"[1, 2]\n", b"\xff\xfe\n", b'{"a": 1}'])
def test_garbage_is_refused_and_harmless(recording: Path, garbage: bytes) -> None:
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as connection:
        connection.connect(str(socket_path(recording)))
        connection.sendall(garbage)
        connection.shutdown(socket.SHUT_WR)
        assert b'"ok": false' in connection.makefile("rb").readline()
    assert send(recording, "double", value=3) == 6


def test_a_mission_that_has_ended_says_so(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    with pytest.raises(NotRunningError, match=r"run\.mcap"):
        send(path, "pause")
    with CommandServer(path, {}):
        pass
    with pytest.raises(NotRunningError):
        send(path, "pause")


def test_only_its_user_may_enter_the_folder(tmp_path: Path) -> None:
    assert socket_path(tmp_path / "run.mcap").parent.stat().st_mode & 0o077 == 0
