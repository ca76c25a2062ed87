"""One direction of a link that takes time, varies and loses messages."""

import heapq
from typing import Generic, TypeVar

import numpy as np

from simulation.loopback.settings import LoopbackSettings

T = TypeVar("T")


class Line(Generic[T]):
    """Gives messages out later than they were put in, by chance in another order, or never."""

    def __init__(self, settings: LoopbackSettings, rng: np.random.Generator) -> None:
        """Begin empty.

        Args:
            settings: Latency, jitter and loss.
            rng: Of jitter and loss.
        """
        self._settings, self._rng = settings, rng
        self._under_way: list[tuple[float, int, T]] = []
        self._count = 0

    def put(self, message: T, now_s: float) -> None:
        """Send a message off."""
        # Both are drawn each time: what happens to one message must not hang on another's luck.
        lost = self._rng.random() < self._settings.loss
        delay_s = self._settings.latency_s + self._settings.jitter_s * self._rng.random()
        self._count += 1
        if not lost:
            heapq.heappush(self._under_way, (now_s + delay_s, self._count, message))

    def due(self, now_s: float) -> list[T]:
        """Return what has arrived by now, in the order of arrival."""
        arrived = []
        while self._under_way and self._under_way[0][0] <= now_s + 1e-9:
            arrived.append(heapq.heappop(self._under_way)[2])
        return arrived

    def clear(self) -> None:
        """Lose everything that is under way."""
        self._under_way.clear()
