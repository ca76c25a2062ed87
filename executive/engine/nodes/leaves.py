"""Leaves of the language that run no skill and ask nothing at once: waits, failures, chance."""

import zlib
from collections.abc import Sequence

from executive.core.clock import Clock
from executive.core.outcome import RUNNING, Outcome, failure, success
from executive.engine.language.amounts import Number, number
from executive.engine.language.scope import Scope
from executive.engine.nodes.leaf import Condition, Leaf
from executive.engine.nodes.supervision import Supervision


class Wait(Leaf):
    """Runs for a while on the clock, then succeeds."""

    MEMORY = ("_due_s",)

    def __init__(
        self, name: str, path: str, seconds: Number, clock: Clock, supervision: Supervision
    ) -> None:
        """Wait for a number of seconds, or for ever."""
        super().__init__(name, path, supervision)
        self._seconds, self._clock = seconds, clock
        self._due_s: float | None = None

    def initialise(self) -> None:
        """Begin a new wait."""
        self._due_s = None

    def answer(self) -> Outcome:
        """Succeed when the time is over."""
        now_s = self._clock.now_s()
        if self._due_s is None:
            self._due_s = now_s + number(self._seconds)
        return success() if now_s >= self._due_s else RUNNING


class WaitFor(Condition):
    """Runs until an expression is true, then succeeds."""

    MEMORY = ()

    def answer(self) -> Outcome:
        """Evaluate the expression."""
        outcome = super().answer()
        return outcome if outcome.reason is None else RUNNING


class Fail(Leaf):
    """Fails with a reason."""

    def __init__(
        self, name: str, path: str, code: str, text: str, supervision: Supervision
    ) -> None:
        """Keep the reason."""
        super().__init__(name, path, supervision)
        self._failure = failure(code, text)

    def answer(self) -> Outcome:
        """Fail."""
        return self._failure


class Unset(Leaf):
    """Takes the values of keys away."""

    def __init__(
        self, name: str, path: str, keys: Sequence[str], scope: Scope, supervision: Supervision
    ) -> None:
        """Keep the keys."""
        super().__init__(name, path, supervision)
        self._keys, self._scope = tuple(keys), scope

    def answer(self) -> Outcome:
        """Forget them, also those that have no value."""
        for key in self._keys:
            self._scope.unset(key, self._path)
        return success()


class Chance(Leaf):
    """Succeeds with a probability; every node draws from a stream of its own."""

    MEMORY = ("_count",)

    def __init__(
        self, name: str, path: str, probability: Number, seed: int, supervision: Supervision
    ) -> None:
        """Begin the stream that belongs to the seed of the run and the path of the node."""
        super().__init__(name, path, supervision)
        self._probability = probability
        self._stream, self._count = (seed, zlib.crc32(path.encode())), 0

    def answer(self) -> Outcome:
        """Draw."""
        probability = number(self._probability)
        drawn = self._draw()
        if drawn < probability:
            return success()
        return failure("chance.missed", f"drew {drawn:.3f}, needed less than {probability:g}")

    def _draw(self) -> float:
        import numpy as np  # not needed to check a tree

        self._count += 1
        return float(np.random.default_rng((*self._stream, self._count)).random())
