"""How a run is paused, resumed and stopped: from another thread, or by a signal."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType


class EmergencyStopped(BaseException):
    """Raised in the middle of a tick by an emergency stop; not for skills to catch."""


class RunControl:
    """Requests to a running mission; every method may be called from any thread.

    Pauses and stops in order take effect between two ticks. An emergency stop brakes at once:
    the thread that asks for it tells the cell itself, whatever the tick is doing, and the
    mission ends when the tick does. One that a signal asks for also breaks into the tick.
    """

    def __init__(self) -> None:
        """Begin without a request."""
        self._changed = threading.Condition(threading.RLock())
        self._braking = threading.RLock()
        self._paused = False
        self._pause_by = ""
        self._stop_reason = ""
        self._emergency = False
        self._interruptible = False
        self._brake: Callable[[], None] | None = None

    @property
    def paused(self) -> bool:
        """Whether the run is to pause, and nobody has asked for its end."""
        return self._paused and not self._stop_reason

    @property
    def pause_by(self) -> str:
        """Who asked last for a pause or its end, or `""`."""
        return self._pause_by

    @property
    def stop_reason(self) -> str:
        """Who asked for a stop, or `""`."""
        return self._stop_reason

    @property
    def emergency(self) -> bool:
        """Whether the stop is an emergency stop."""
        return self._emergency

    def pause(self, by: str = "another thread") -> None:
        """Tick no more until `resume`; running leaves do what their pause policies say."""
        self._set_paused(True, by)

    def resume(self, by: str = "another thread") -> None:
        """Go on after `pause`."""
        self._set_paused(False, by)

    def stop(self, reason: str) -> None:
        """End the mission in order before the next tick."""
        with self._changed:
            self._stop_reason = self._stop_reason or reason
            self._changed.notify_all()

    def emergency_stop(self, reason: str) -> None:
        """Stop the arms now, from the calling thread, and end the mission.

        Raises:
            Exception: What the cell raised; the mission ends all the same, and tries again.
        """
        self._ask_for_emergency_stop(reason)
        self.brake()

    def brakes_with(self, brake: Callable[[], None]) -> None:
        """Say how the cell is stopped in an emergency; the runner does so when it begins."""
        self._brake = brake

    def brake(self) -> None:
        """Make the emergency stop of the cell, once; whoever comes second waits for the first.

        Raises:
            Exception: What the cell raised; the next call tries again.
        """
        with self._braking:
            if self._brake is not None:
                self._brake()
                self._brake = None

    def wait(self, timeout_s: float) -> None:
        """Wait for a request, that long at most."""
        with self._changed:
            if self.paused:
                self._changed.wait(timeout_s)

    @contextmanager
    def interruptible(self) -> Iterator[None]:
        """Let the signal of an emergency stop break into the block; blocks may be nested."""
        before, self._interruptible = self._interruptible, True
        try:
            yield
        finally:
            self._interruptible = before

    def on_signal(self, number: int, _frame: FrameType | None) -> None:
        """Stop in order on the first signal, at once on the second."""
        name = signal.Signals(number).name
        if not self._stop_reason:
            self.stop(name)
            return
        self._ask_for_emergency_stop(name)
        if self._interruptible:
            self._interruptible = False
            raise EmergencyStopped
        # A signal comes between any two instructions, maybe inside a call to the cell: only
        # another thread can wait for that call.
        threading.Thread(target=self.brake, name="emergency stop", daemon=True).start()

    def on_pause_signal(self, number: int, _frame: FrameType | None) -> None:
        """Pause on the first signal, go on with the next."""
        self._set_paused(not self._paused, signal.Signals(number).name)

    def _set_paused(self, paused: bool, by: str) -> None:
        with self._changed:
            if paused != self._paused:
                self._paused, self._pause_by = paused, by
            self._changed.notify_all()

    def _ask_for_emergency_stop(self, reason: str) -> None:
        with self._changed:
            self._emergency = True
            self.stop(reason)


@contextmanager
def stopped_by_signals(control: RunControl) -> Iterator[None]:
    """Let signals stop and pause a run while the block lasts; main thread only.

    SIGINT (Ctrl-C) and SIGTERM stop it, in order first, at once the second time. SIGTSTP
    (Ctrl-Z) pauses it and lets it go on: a process that stands still would leave its arms
    moving.
    """
    handlers = {
        signal.SIGINT: control.on_signal,
        signal.SIGTERM: control.on_signal,
        signal.SIGTSTP: control.on_pause_signal,
    }
    before = {number: signal.signal(number, handler) for number, handler in handlers.items()}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
