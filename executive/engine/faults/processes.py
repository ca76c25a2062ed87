"""Runs commands in processes of their own, some at a time; one that dies loses only itself."""

import os
import signal
import subprocess
import threading
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from contextlib import suppress
from dataclasses import dataclass

GRACE_S = 10.0
"""What a process has to end in order after it was asked to [s]."""


@dataclass(frozen=True, slots=True)
class Ended:
    """How a process ended.

    Attributes:
        code: Its exit code; negative for the number of a signal.
        stdout: What it printed.
        last_words: Last line of what it said on stderr.
        wall_s: How long it took on the machine's clock [s].
        overdue: Whether it was ended because it took too long.
    """

    code: int
    stdout: str
    last_words: str
    wall_s: float
    overdue: bool


class Processes:
    """Processes that are ended with the block that they are started in."""

    def __init__(self, workers: int, limit_s: float) -> None:
        """Run at most `workers` at a time, each for at most `limit_s` here [s]."""
        self._workers, self._limit_s = workers, limit_s
        self._lock = threading.Lock()
        self._running: set[subprocess.Popen[str]] = set()
        self._closed = False

    def run(self, commands: Sequence[Sequence[str]]) -> Iterator[tuple[int, Ended]]:
        """Run commands; yield the place of each and how it ended, as they end.

        An exception that is raised meanwhile, an interrupt too, ends all that still run.
        """
        pool, self._closed = ThreadPoolExecutor(self._workers), False
        try:
            places: dict[Future[Ended], int] = {
                pool.submit(self._one, command): place for place, command in enumerate(commands)
            }
            for future in as_completed(places):
                yield places[future], future.result()
        finally:
            self._close()
            pool.shutdown(cancel_futures=True)

    def _one(self, command: Sequence[str]) -> Ended:
        # A command that is tied to its standard input ends with this process.
        tether, held = os.pipe()
        try:
            return self._tethered(command, tether)
        finally:
            os.close(tether)
            os.close(held)

    def _tethered(self, command: Sequence[str], tether: int) -> Ended:
        began_s = time.monotonic()
        with self._lock:
            if self._closed:
                return Ended(-signal.SIGTERM, "", "", 0.0, overdue=False)
            process = subprocess.Popen(
                command,
                stdin=tether,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
                errors="replace",
                start_new_session=True,
            )
            self._running.add(process)
        overdue = False
        try:
            stdout, stderr = process.communicate(timeout=self._limit_s)
        except subprocess.TimeoutExpired:
            overdue = True
            stdout, stderr = _ended(process)
        finally:
            with self._lock:
                self._running.discard(process)
        lines = stderr.strip().splitlines()
        wall_s = time.monotonic() - began_s
        return Ended(process.returncode, stdout, lines[-1] if lines else "", wall_s, overdue)

    def _close(self) -> None:
        with self._lock:
            self._closed = True
            for process in self._running:
                _signal(process, signal.SIGKILL)


def _ended(process: "subprocess.Popen[str]") -> tuple[str, str]:
    """Ask a process to end, and make it; return what it has printed."""
    _signal(process, signal.SIGTERM)
    try:
        return process.communicate(timeout=GRACE_S)
    except subprocess.TimeoutExpired:
        _signal(process, signal.SIGKILL)
        return process.communicate()


def _signal(process: "subprocess.Popen[str]", number: signal.Signals) -> None:
    with suppress(ProcessLookupError):  # it may have ended just now
        os.killpg(process.pid, number)
