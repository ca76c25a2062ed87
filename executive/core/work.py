"""Work that takes longer than a tick: begun in one tick, asked for in the later ones.

A skill hands a function to the cell's `worker` and goes on when there is an answer:

    def __init__(self, worker: Worker, vision: CableVision) -> None: ...

    def run(self, frame: CameraFrame) -> SkillRun:
        trace = yield from self._worker.run(self._vision.trace, frame.image)

What the function raises is raised there. When the skill is halted, the work is cancelled.
Which worker a cell has is decided where the cell is put together: in a world that is stepped
in lockstep with the ticks, the same seed gives the same run only with `InlineWorker`.
"""

import threading
from abc import ABC, abstractmethod
from collections.abc import Callable, Generator
from contextlib import suppress
from functools import partial
from typing import Any, Concatenate, Generic, ParamSpec, TypeVar, final

from executive.core.errors import DeviceError

P = ParamSpec("P")
T = TypeVar("T")


class Cancelled(Exception):  # noqa: N818 - nothing went wrong: nobody wants the answer any more
    """Raised in work by `CancelToken.check` once nobody waits for it."""


class CancelToken:
    """Tells work that nobody waits for it any more."""

    def __init__(self) -> None:
        """Begin without a wish to cancel."""
        self._event = threading.Event()

    def __reduce__(self) -> tuple[type["CancelToken"], tuple[()]]:
        """Cross to another process as a fresh one: there, to cancel is to end the process."""
        return CancelToken, ()

    @property
    def cancelled(self) -> bool:
        """Whether the work may as well stop."""
        return self._event.is_set()

    def cancel(self) -> None:
        """Say that nobody waits any more."""
        self._event.set()

    def check(self) -> None:
        """Leave the work from inside.

        Raises:
            Cancelled: Nobody waits any more.
        """
        if self.cancelled:
            raise Cancelled


class Work(ABC, Generic[T]):
    """One function that has been begun."""

    @property
    @abstractmethod
    def done(self) -> bool:
        """Whether there is an answer; never blocks."""

    @abstractmethod
    def result(self) -> T:
        """Return what the function returned, or raise what it raised; only once `done`."""

    @abstractmethod
    def cancel(self) -> None:
        """Drop what is not done yet; called once, also after `result`."""


class Worker(ABC):
    """Does work beside the ticks; the device `worker` of a cell."""

    @final
    def run(
        self, function: Callable[P, T], *args: P.args, **kwargs: P.kwargs
    ) -> Generator[None, None, T]:
        """Have a function called and wait for it, a tick at least.

        Use it with `yield from` in a skill.

        Returns:
            What the function returned.

        Raises:
            Exception: Whatever the function raised.
            DeviceError: The worker cannot take the work, or lost it.
        """
        return self._wait(CancelToken(), partial(function, *args, **kwargs))

    @final
    def run_cancellable(
        self, function: Callable[Concatenate[CancelToken, P], T], *args: P.args, **kwargs: P.kwargs
    ) -> Generator[None, None, T]:
        """As `run`, for a function that takes a token first and looks at it now and then."""
        token = CancelToken()
        return self._wait(token, partial(function, token, *args, **kwargs))

    def _wait(self, token: CancelToken, call: Callable[[], T]) -> Generator[None, None, T]:
        work = self.begin(token, call)
        try:
            yield
            while not work.done:
                yield
            return work.result()
        finally:
            work.cancel()

    @abstractmethod
    def begin(self, token: CancelToken, call: Callable[[], T]) -> Work[T]:
        """Begin to call something.

        Args:
            token: Set by the work when it is cancelled.
            call: What to do.

        Raises:
            DeviceError: It cannot be begun.
        """

    def close(self) -> None:  # noqa: B027 - most workers keep nothing
        """Cancel what is under way; called once, when the cell is closed."""


class InlineWorker(Worker):
    """Does the work at once, in the tick that asks, and answers in the next one.

    It blocks that tick, which costs nothing in a world whose clock stands still meanwhile.
    """

    def begin(self, token: CancelToken, call: Callable[[], T]) -> Work[T]:
        """Do it."""
        work = _CalledWork(token, call)
        work.call()
        return work


class ThreadWorker(Worker):
    """Does each piece of work in a thread of its own.

    A thread cannot be ended from outside: cancelled work goes on until it looks at its token or
    returns, and its answer is dropped.
    """

    def __init__(self, most: int = 8) -> None:
        """Prepare; `most` pieces of work may be under way at a time."""
        self._most = most
        self._under_way: list[tuple[threading.Thread, _CalledWork[Any]]] = []

    def begin(self, token: CancelToken, call: Callable[[], T]) -> Work[T]:
        """Begin it in a new thread.

        Raises:
            DeviceError: Too much work is under way.
        """
        self._under_way = [one for one in self._under_way if one[0].is_alive()]
        if len(self._under_way) >= self._most:
            names = ", ".join(sorted({work.name for _, work in self._under_way}))
            raise DeviceError(
                f"worker: too much work is under way; got {name_of(call)} while "
                f"{len(self._under_way)} go on ({names}); expected at most {self._most}; "
                "try functions that look at their cancel token"
            )
        work = _CalledWork(token, call)
        # A daemon, so that work which never ends cannot keep the program from ending.
        thread = threading.Thread(target=work.call_apart, name=f"work {work.name}", daemon=True)
        self._under_way.append((thread, work))
        thread.start()
        return work

    def close(self) -> None:
        """Cancel what is under way."""
        for _, work in self._under_way:
            work.cancel()


class _CalledWork(Work[T]):
    """A call in this process, in whatever thread calls `call`."""

    def __init__(self, token: CancelToken, call: Callable[[], T]) -> None:
        self.name = name_of(call)
        self._token, self._function = token, call
        self._answer: list[T] = []
        self._error: Exception | None = None
        self._done = threading.Event()

    def call(self) -> None:
        try:
            self._answer.append(self._function())
        except Exception as error:  # it belongs to the skill that waits
            self._error = error
        finally:
            self._done.set()

    def call_apart(self) -> None:
        with suppress(SystemExit):  # which would end the thread and tell nobody
            self.call()

    @property
    def done(self) -> bool:
        return self._done.is_set()

    def result(self) -> T:
        if self._error is not None:
            raise self._error
        if not self._answer:  # e.g. sys.exit() in a thread
            raise DeviceError(f"worker: {self.name} ended without an answer")
        return self._answer[0]

    def cancel(self) -> None:
        self._token.cancel()


def name_of(call: Callable[[], object]) -> str:
    """Return what to call a piece of work in a message."""
    function = call.func if isinstance(call, partial) else call
    return getattr(function, "__qualname__", type(function).__name__)
