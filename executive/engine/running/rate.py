"""When the next tick is due, and how well the rate was kept."""

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class RateReport:
    """How well a tick rate was kept.

    Attributes:
        wanted_hz: The rate that was asked for.
        achieved_hz: Ticks a second of the clock; 0 with fewer than two ticks.
        p99_tick_s: 99th percentile of how long a tick took [s].
        overruns: Ticks that began late because the one before was not done.
    """

    wanted_hz: float
    achieved_hz: float
    p99_tick_s: float
    overruns: int


class Rate:
    """A fixed grid of due times; a late tick skips to the next point, and is counted."""

    def __init__(
        self, rate_hz: float, start_s: float, *, now_s: float | None = None, paused_s: float = 0.0
    ) -> None:
        """Put a tick at `start_s`; a run that goes on has had some, and pauses, by `now_s`."""
        self._rate_hz = rate_hz
        self._origin_s = start_s
        self._slot = 0 if now_s is None else self._next_slot(now_s)
        self._paused_before_s = paused_s
        self._begins_s: list[float] = []
        self._durations_s: list[float] = []
        self._overruns = 0
        self.paused_s = paused_s

    @property
    def origin_s(self) -> float:
        """A point of the grid."""
        return self._origin_s

    def ticked(self, begin_s: float, duration_s: float) -> None:
        """Note one tick: when it began on the clock, and how long it took."""
        self._begins_s.append(begin_s)
        self._durations_s.append(duration_s)

    def next_due_s(self, now_s: float) -> float:
        """Return when the next tick is due; points of the grid that have passed are skipped."""
        self._slot += 1
        due_s = self._origin_s + self._slot / self._rate_hz
        if due_s < now_s - 1e-9:
            self._overruns += 1
            self._slot = self._next_slot(now_s)
            due_s = self._origin_s + self._slot / self._rate_hz
        return due_s

    def skip(self, pause_s: float) -> None:
        """Move the grid by a pause, which counts neither as an overrun nor as time."""
        self._origin_s += pause_s
        self.paused_s += pause_s

    def report(self) -> RateReport:
        """Return how well the rate was kept so far."""
        durations_s = sorted(self._durations_s)
        p99_s = durations_s[math.ceil(0.99 * len(durations_s)) - 1] if durations_s else 0.0
        paused_s = self.paused_s - self._paused_before_s
        span_s = self._begins_s[-1] - self._begins_s[0] - paused_s if self._begins_s else 0.0
        achieved_hz = (len(self._begins_s) - 1) / span_s if span_s > 0.0 else 0.0
        return RateReport(self._rate_hz, achieved_hz, p99_s, self._overruns)

    def _next_slot(self, now_s: float) -> int:
        return math.ceil((now_s - self._origin_s) * self._rate_hz - 1e-9)
