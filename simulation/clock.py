"""The clock of a simulated world: waiting is what makes its physics go on."""

import math
from collections.abc import Callable


class SimClock:
    """Counts steps of a fixed length, so that time has no rounding that could build up."""

    def __init__(self, step_s: float, advance: Callable[[int], None]) -> None:
        """Start at zero.

        Args:
            step_s: Length of one step of the world.
            advance: Lets the world take that many steps.
        """
        self._step_s = step_s
        self._advance = advance
        self._steps = 0

    def now_s(self) -> float:
        """Return the simulated time [s]."""
        return self._steps * self._step_s

    def sleep_until(self, time_s: float) -> None:
        """Step the world until `now_s() >= time_s`; returns at once when that has passed."""
        # A hair more than a whole number of steps is rounding, no reason for one more.
        wanted = math.ceil(time_s / self._step_s - 1e-6)
        if wanted > self._steps:
            self._advance(wanted - self._steps)
            self._steps = wanted
