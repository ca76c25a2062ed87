"""A fault that is armed in a run: what it means there, and how often it has happened."""

import zlib
from dataclasses import dataclass

from executive.engine.faults.grammar import Injection
from executive.engine.recording.messages import InjectedReport


@dataclass(slots=True, eq=False)
class Armed:
    """One fault in one run.

    Attributes:
        injection: The fault.
        seed: Seed of the run.
        times: How often it has happened.
        first_tick: Tick in which it happened first.
        places: Nodes and keys at which it happened, in order.
    """

    injection: Injection
    seed: int
    times: int = 0
    first_tick: int | None = None
    places: dict[str, None] | None = None

    def happens(self, place: str, number: int) -> bool:
        """Return whether it happens in an activation or a write, counted from 1.

        Chance is drawn for each place and number alone, so that one fault does not change
        when another one happens.
        """
        if not self.injection.is_for(number):
            return False
        if self.injection.probability == 1.0:
            return True
        import numpy as np  # most faults leave nothing to chance

        stream = zlib.crc32(f"{self.injection.text}\n{place}".encode())
        drawn = np.random.default_rng((self.seed, stream, number)).random()
        return bool(drawn < self.injection.probability)

    def note(self, place: str, tick: int) -> None:
        """Take note that it has happened."""
        self.times += 1
        if self.first_tick is None:
            self.first_tick = tick
        self.places = {**(self.places or {}), place: None}

    def report(self) -> InjectedReport:
        """Return what came of it."""
        return InjectedReport(
            fault=self.injection.text,
            times=self.times,
            first_tick=self.first_tick,
            places=tuple(self.places or ()),
        )
