"""Holds a run to a multiple of real time, so that people can follow a simulation."""

import time
from collections.abc import Callable, Sequence

from executive.core.world import StreamMessage
from executive.engine.ticks import Tick


class Pace:
    """An observer that waits after each tick until the machine's clock has come as far.

    What a tick takes longer is not made up for by faster ones after it.
    """

    def __init__(
        self,
        speed: float,
        *,
        now_s: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        """Hold to a speed.

        Args:
            speed: Seconds on the cell's clock for each second on the machine's, at most.
            now_s: The machine's clock [s].
            sleep: Waits so long [s] on it.
        """
        self._speed, self._now_s, self._sleep = speed, now_s, sleep
        self._last: tuple[float, float] | None = None

    def on_tick(self, tick: Tick) -> None:
        """Wait for as long as the time since the last tick should have taken."""
        now_s = self._now_s()
        if self._last is not None:
            cell_s, machine_s = self._last
            left_s = machine_s + (tick.time_s - cell_s) / self._speed - now_s
            if left_s > 0.0:
                self._sleep(left_s)
                now_s += left_s  # sleeping too long does not add up
        self._last = (tick.time_s, now_s)

    def on_streams(self, messages: Sequence[StreamMessage]) -> None:
        """Take no notice of what the cell streams."""
