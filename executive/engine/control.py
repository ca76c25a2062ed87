"""How a run is paused, resumed and stopped: from another thread, or by a signal."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


class EmergencyStopped(BaseException):
    """Raised in the middle of a tick by an emergency stop; not for skills to catch."""


class RunControl:
    """Requests to a running mission; every method may be called from any thread.

    A stop in order takes effect between two ticks. So does an emergency stop that another
    thread asks for; one that a signal asks for interrupts the tick.
    """

    def __init__(self) -> None:
        """Begin without a request."""
        self._changed = threading.Condition(threading.RLock())
        self._paused = False
        self._stop_reason = ""
        self._emergency = False
        self._interruptible = False

    @property
    def stop_reason(self) -> str:
        """Who asked for a stop, or `""`."""
        return self._stop_reason

    @property
    def emergency(self) -> bool:
        """Whether the stop is an emergency stop."""
        return self._emergency

    def pause(self) -> None:
        """Tick no more until `resume`; motions that were started come to their end."""
        with self._changed:
            self._paused = True

    def resume(self) -> None:
        """Go on after `pause`."""
        with self._changed:
            self._paused = False
            self._changed.notify_all()

    def stop(self, reason: str) -> None:
        """End the mission in order before the next tick."""
        with self._changed:
            self._stop_reason = self._stop_reason or reason
            self._changed.notify_all()

    def emergency_stop(self, reason: str) -> None:
        """End the mission now: arms stop as fast as they can."""
        with self._changed:
            self._emergency = True
            self.stop(reason)

    def wait_while_paused(self) -> bool:
        """Block until the run may go on or shall end; return whether it was paused at all."""
        with self._changed:
            paused = self._paused
            while self._paused and not self._stop_reason:
                self._changed.wait()
            return paused

    @contextmanager
    def interruptible(self) -> Iterator[None]:
        """Let the signal of an emergency stop break into the block."""
        self._interruptible = True
        try:
            yield
        finally:
            self._interruptible = False

    def on_signal(self, number: int, _frame: FrameType | None) -> None:
        """Stop in order on the first signal, at once on the second."""
        name = signal.Signals(number).name
        if not self._stop_reason:
            self.stop(name)
            return
        self.emergency_stop(name)
        if self._interruptible:
            self._interruptible = False
            raise EmergencyStopped


@contextmanager
def stopped_by_signals(control: RunControl) -> Iterator[None]:
    """Let SIGINT and SIGTERM stop a run while the block lasts; main thread only."""
    numbers = (signal.SIGINT, signal.SIGTERM)
    before = [signal.signal(number, control.on_signal) for number in numbers]
    try:
        yield
    finally:
        for number, handler in zip(numbers, before, strict=True):
            signal.signal(number, handler)
