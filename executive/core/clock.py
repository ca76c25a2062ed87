"""Time is injected: in simulation the world's, on a real cell the machine's."""

import time
from typing import Protocol, runtime_checkable


@runtime_checkable
class Clock(Protocol):
    """Where time comes from, and how to wait in it."""

    def now_s(self) -> float:
        """Return the time since the clock's own start [s]; it never goes back."""
        ...

    def sleep_until(self, time_s: float) -> None:
        """Return once `now_s() >= time_s`; a simulated world is stepped on meanwhile."""
        ...


class MonotonicClock:
    """The machine's monotonic clock, counted from construction."""

    def __init__(self) -> None:
        """Start at zero."""
        self._start_s = time.monotonic()

    def now_s(self) -> float:
        """Return seconds since construction."""
        return time.monotonic() - self._start_s

    def sleep_until(self, time_s: float) -> None:
        """Sleep for what is left, or return at once when it has passed."""
        left_s = time_s - self.now_s()
        if left_s > 0.0:
            time.sleep(left_s)


class MissionClock:
    """The clock of a cell without the time for which a mission was paused.

    Timeouts and delays of a tree are on it, so that no pause makes them pass. In a run it stands
    during a tick: what nodes decide by it is then known from the time of the tick alone.
    """

    def __init__(self, clock: Clock) -> None:
        """Bind the clock of a cell; nothing is left out yet, and it goes on."""
        self._clock = clock
        self._paused_s = 0.0
        self._held_s: float | None = None

    def now_s(self) -> float:
        """Return the time of the cell less all pauses [s], or the one that it is held at."""
        return self._clock.now_s() - self._paused_s if self._held_s is None else self._held_s

    def hold(self, time_s: float) -> None:
        """Stand at a time of the cell's clock [s] until the next call."""
        self._held_s = time_s - self._paused_s

    def sleep_until(self, time_s: float) -> None:
        """Wait on the clock of the cell."""
        self._clock.sleep_until(time_s + self._paused_s)

    def skip(self, pause_s: float) -> None:
        """Leave out a pause that has just ended."""
        self._paused_s += pause_s


class ManualClock:
    """A clock that only moves when it is told to; for tests and dry runs."""

    def __init__(self) -> None:
        """Start at zero."""
        self._now_s = 0.0

    def now_s(self) -> float:
        """Return the time it was last moved to."""
        return self._now_s

    def sleep_until(self, time_s: float) -> None:
        """Jump to `time_s` unless that is in the past."""
        self._now_s = max(self._now_s, time_s)
