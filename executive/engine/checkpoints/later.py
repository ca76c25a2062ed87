"""A cell that cannot be put back, seen by a mission for which no time has passed since."""

from collections.abc import Iterable, Mapping
from dataclasses import replace

from executive.core.clock import Clock
from executive.core.world import Cell, StreamMessage


class LaterClock:
    """A clock that begins at another time."""

    def __init__(self, clock: Clock, time_s: float) -> None:
        """Let a clock show `time_s` now."""
        self._clock, self._ahead_s = clock, time_s - clock.now_s()

    @property
    def ahead_s(self) -> float:
        """What it shows more than the clock behind it [s]."""
        return self._ahead_s

    def now_s(self) -> float:
        """Return the time."""
        return self._clock.now_s() + self._ahead_s

    def sleep_until(self, time_s: float) -> None:
        """Wait on the clock behind it."""
        self._clock.sleep_until(time_s - self._ahead_s)


class LaterCell:
    """A cell whose clock, also that of what it streams, goes on where it was."""

    def __init__(self, cell: Cell, time_s: float) -> None:
        """Let the clock of a cell show `time_s` now."""
        self._cell, self._clock = cell, LaterClock(cell.clock, time_s)
        self.devices: Mapping[str, object] = {
            name: self._clock if device is cell.clock else device
            for name, device in cell.devices.items()
        }

    @property
    def clock(self) -> Clock:
        """The clock that goes on."""
        return self._clock

    def drain_streams(self) -> Iterable[StreamMessage]:
        """Return what has happened since the last call, on the clock that goes on."""
        for message in self._cell.drain_streams():
            yield replace(message, time_s=message.time_s + self._clock.ahead_s)

    def stop(self) -> None:
        """Bring the cell to rest."""
        self._cell.stop()

    def emergency_stop(self) -> None:
        """Stop the cell."""
        self._cell.emergency_stop()

    def close(self) -> None:
        """Close the cell."""
        self._cell.close()

    def truth(self) -> object | None:
        """Return what the cell knows."""
        return self._cell.truth()
