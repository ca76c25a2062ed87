"""How far a training is, and how that is told."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import inf
from typing import Protocol

QUIET_S = 60.0


@dataclass(frozen=True, slots=True)
class Progress:
    """Where a training stands.

    Attributes:
        seen: Samples so far.
        samples: Samples after which it ends.
        hours: Process time so far [h].
        most_hours: Process time after which it ends [h], none for no limit.
        rate_per_s: Samples a second of late.
        left_s: Time to the end, as it goes now [s].
        loss: Of the last batch.
    """

    seen: int
    samples: int
    hours: float
    most_hours: float | None
    rate_per_s: float
    left_s: float
    loss: float

    @property
    def share(self) -> float:
        """How much of it is done, from 0 to 1."""
        by_time = 0.0 if self.most_hours is None else self.hours / self.most_hours
        return min(max(self.seen / self.samples, by_time), 1.0)


class Reporter(Protocol):
    """Tells of a training while it goes on."""

    def step(self, progress: Progress) -> None:
        """Take note of every batch."""
        ...

    def figures(self, progress: Progress, figures: Mapping[str, float]) -> None:
        """Tell of figures about held-out samples, every few minutes."""
        ...

    def note(self, text: str) -> None:
        """Tell of anything else."""
        ...


def _print(text: str) -> None:
    print(text, flush=True)  # noqa: T201  # progress of a command that runs for hours


class PlainReporter:
    """Writes a line for each set of figures, and one a minute in between.

    Args:
        write: Takes each line.
    """

    def __init__(self, write: Callable[[str], None] = _print) -> None:
        self._write, self._written = write, time.perf_counter()

    def step(self, progress: Progress) -> None:
        """Say where it stands, once a minute."""
        if time.perf_counter() - self._written > QUIET_S:
            self.note(describe(progress))

    def figures(self, progress: Progress, figures: Mapping[str, float]) -> None:
        """Say where it stands, and the figures."""
        self.note(f"{describe(progress)}  {shown(figures)}")

    def note(self, text: str) -> None:
        """Write a text."""
        self._written = time.perf_counter()
        self._write(text)


def describe(progress: Progress) -> str:
    """Return one line about where a training stands."""
    most = "" if progress.most_hours is None else f" of {progress.most_hours:.2f}"
    return (
        f"{progress.share:4.0%}  {progress.seen} of {progress.samples} samples"
        f"  {progress.hours:.2f}{most} h of process time"
        f"  {progress.rate_per_s:.0f} samples/s  about {duration(progress.left_s)} left"
        f"  loss {progress.loss:.4f}"
    )


def shown(figures: Mapping[str, float]) -> str:
    """Return figures as text."""
    return "  ".join(f"{name} {value:.4f}" for name, value in figures.items())


def duration(seconds: float) -> str:
    """Return a time in words of its size."""
    if not seconds < inf:
        return "some time"
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 5400.0 else f"{seconds / 3600.0:.1f} h"
