"""The clock of a simulated world: waiting is what makes its physics go on."""

import math
from typing import Protocol


class SteppedWorld(Protocol):
    """A world whose time is a number of equal steps."""

    @property
    def step_s(self) -> float:
        """Length of a step [s]."""
        ...

    @property
    def steps(self) -> int:
        """Steps taken since the world began."""
        ...

    def advance(self, steps: int) -> None:
        """Take that many steps."""
        ...


class SimClock:
    """Tells a world's time and lets it pass; whole steps are counted, so no rounding builds up."""

    def __init__(self, world: SteppedWorld) -> None:
        """Bind a world; no time passes."""
        self._world = world

    def now_s(self) -> float:
        """Return the simulated time [s]."""
        return self._world.steps * self._world.step_s

    def sleep_until(self, time_s: float) -> None:
        """Step the world until `now_s() >= time_s`; returns at once when that has passed."""
        # A hair more than a whole number of steps is rounding, no reason for one more.
        wanted = math.ceil(time_s / self._world.step_s - 1e-6)
        if wanted > self._world.steps:
            self._world.advance(wanted - self._world.steps)
