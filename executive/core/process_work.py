"""Work in processes of their own: it cannot slow the ticks down, and it can be ended."""

import multiprocessing
import pickle
import signal
import traceback
from collections.abc import Callable
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any, TypeVar

from executive.core.errors import DeviceError
from executive.core.work import CancelToken, Work, Worker, name_of

T = TypeVar("T")
_END_S = 1.0
_UNPICKLABLE = (pickle.PicklingError, TypeError, AttributeError)


class ProcessWorker(Worker):
    """Does each piece of work in a process of its own.

    Functions, arguments and answers are pickled. Work that is cancelled is killed, so it must
    not hold anything that has to be given back.
    """

    def __init__(self) -> None:
        """Prepare; the first piece of work starts the server that processes are forked from."""
        # Forking this process itself would copy locks that its other threads hold.
        self._context = multiprocessing.get_context("forkserver")
        self._under_way: list[_ProcessWork[Any]] = []

    def begin(self, token: CancelToken, call: Callable[[], T]) -> Work[T]:
        """Begin it in a new process.

        Raises:
            DeviceError: The function or an argument cannot be pickled.
        """
        self._under_way = [work for work in self._under_way if not work.ended]
        receiver, sender = self._context.Pipe(duplex=False)
        process = self._context.Process(target=_do, args=(sender, call), daemon=True)
        try:
            process.start()
        except _UNPICKLABLE as cause:
            receiver.close()
            raise DeviceError(
                f"worker: {name_of(call)} cannot be sent to another process; got {cause}; "
                "try a function of a module and arguments that can be pickled"
            ) from cause
        finally:
            sender.close()
        work: _ProcessWork[T] = _ProcessWork(token, name_of(call), process, receiver)
        self._under_way.append(work)
        return work

    def close(self) -> None:
        """Kill what is under way."""
        for work in self._under_way:
            work.cancel()


class _ProcessWork(Work[T]):
    def __init__(
        self, token: CancelToken, name: str, process: BaseProcess, receiver: Connection
    ) -> None:
        self._token, self._name = token, name
        self._process, self._receiver = process, receiver
        self.ended = False

    @property
    def done(self) -> bool:
        # The end of the pipe counts too: that is all that a process leaves which was killed.
        return self._receiver.poll()

    def result(self) -> T:
        try:
            answer, error, trace = pickle.loads(self._receiver.recv_bytes())
        except EOFError:
            self._process.join(_END_S)
            raise DeviceError(
                f"worker: the process of {self._name} ended without an answer; "
                f"exit code {self._process.exitcode}"
            ) from None
        if error is not None:
            raise error from _RemoteTraceback(trace)
        value: T = answer
        return value

    def cancel(self) -> None:
        if self.ended:
            return
        self.ended = True
        self._token.cancel()
        self._process.kill()
        self._process.join(_END_S)
        self._receiver.close()


class _RemoteTraceback(Exception):  # noqa: N818 - it only shows where an error came from
    """Where an error was raised in another process."""

    def __str__(self) -> str:
        return f"\n{self.args[0]}"


def _do(sender: Connection, call: Callable[[], object]) -> None:
    """Do the work and send what came of it; runs in the other process."""
    # A Ctrl-C in the terminal is for the mission, which ends its processes itself.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        answer = pickle.dumps((call(), None, ""))
    except Exception as error:
        answer = _pickled(error, traceback.format_exc())
    sender.send_bytes(answer)


def _pickled(error: Exception, trace: str) -> bytes:
    """Return an error as it crosses; one that cannot becomes a text."""
    try:
        data = pickle.dumps((None, error, trace))
        # Errors whose constructor takes other arguments than it passes on fail only here.
        pickle.loads(data)
    except Exception:
        return pickle.dumps((None, DeviceError(f"{type(error).__name__}: {error}"), trace))
    return data
