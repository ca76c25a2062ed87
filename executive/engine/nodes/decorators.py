"""Nodes with one child.

py_trees' own are used where they do what they say; these are here because its Retry and
Repeat know no delay, its Timeout reads the machine's clock and ticks the child even when it
is late (trap e8), and its ForEach runs the child for an empty list (trap e9).
"""

from collections.abc import Collection, Iterator

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.core.clock import Clock
from executive.core.errors import InputError
from executive.core.outcome import Outcome
from executive.engine.language.amounts import Number, number
from executive.engine.language.scope import Scope, evaluate
from executive.engine.language.values import Value
from executive.engine.nodes.gated import Gated


class Retry(Gated):
    """Runs the child again when it fails; at most one attempt in a tick."""

    MEMORY = ("_failures", "_times", "_delay_s", "_resume_s")

    def __init__(
        self,
        name: str,
        child: Behaviour,
        *,
        times: Number,
        delay_s: Number = 0.0,
        backoff: float = 1.0,
        gives_up_on: Collection[str] = (),
        clock: Clock,
    ) -> None:
        """Allow some attempts.

        Args:
            name: Name of the node.
            child: The child.
            times: Attempts in all.
            delay_s: Pause after the first failure [s].
            backoff: Factor by which the pause grows with every failure.
            gives_up_on: Codes of reasons after which there is no other attempt.
            clock: What the pauses are measured on.
        """
        super().__init__(name, child)
        self._asked, self._backoff, self._clock = (times, delay_s), backoff, clock
        self._gives_up_on = frozenset(gives_up_on)
        self._times, self._delay_s = 0.0, 0.0
        self._failures, self._resume_s = 0, 0.0

    def initialise(self) -> None:
        """Forget earlier attempts, and take the numbers as they are now."""
        self._times, self._delay_s = map(number, self._asked)
        self._failures, self._resume_s = 0, self._clock.now_s()

    def before(self) -> Status | None:
        """Wait until the pause is over."""
        return Status.RUNNING if self._clock.now_s() < self._resume_s else None

    def update(self) -> Status:
        """Count a failure and go on, unless it was the last attempt."""
        if self.decorated.status is not Status.FAILURE:
            return self.decorated.status
        self._failures += 1
        self._resume_s = self._clock.now_s() + self._delay_s
        self._delay_s *= self._backoff
        hopeless = not self._gives_up_on.isdisjoint(failure_codes(self.decorated))
        return Status.FAILURE if hopeless or self._failures >= self._times else Status.RUNNING


class Repeat(Gated):
    """Runs the child again when it succeeds; at most one round in a tick."""

    MEMORY = ("_successes", "_times", "_delay_s", "_resume_s")

    def __init__(
        self, name: str, child: Behaviour, *, times: Number, delay_s: Number = 0.0, clock: Clock
    ) -> None:
        """Ask for `times` successes with a pause after each [s]."""
        super().__init__(name, child)
        self._asked, self._clock = (times, delay_s), clock
        self._times, self._delay_s = 0.0, 0.0
        self._successes, self._resume_s = 0, 0.0

    def initialise(self) -> None:
        """Forget earlier rounds, and take the numbers as they are now."""
        self._times, self._delay_s = map(number, self._asked)
        self._successes, self._resume_s = 0, self._clock.now_s()

    def before(self) -> Status | None:
        """Wait until the pause is over."""
        return Status.RUNNING if self._clock.now_s() < self._resume_s else None

    def update(self) -> Status:
        """Count a success and go on, unless it was the last round."""
        if self.decorated.status is not Status.SUCCESS:
            return self.decorated.status
        self._successes += 1
        self._resume_s = self._clock.now_s() + self._delay_s
        return Status.SUCCESS if self._successes >= self._times else Status.RUNNING


class Timeout(Gated):
    """Halts the child and fails when it is not done in time."""

    MEMORY = ("_seconds", "_deadline_s")

    def __init__(self, name: str, child: Behaviour, *, seconds: Number, clock: Clock) -> None:
        """Allow a number of seconds on the clock."""
        super().__init__(name, child)
        self._asked, self._clock = seconds, clock
        self._seconds, self._deadline_s = 0.0, 0.0

    def initialise(self) -> None:
        """Start the clock."""
        self._seconds = number(self._asked)
        self._deadline_s = self._clock.now_s() + self._seconds

    def before(self) -> Status | None:
        """Fail when it is late; the child gets no tick then."""
        if self._clock.now_s() < self._deadline_s:
            return None
        return self.fail("timeout", f"not done after {self._seconds:g} s")


class Cooldown(Gated):
    """Fails without starting the child for a while after it has finished."""

    MEMORY = ("_seconds", "_ready_s")

    def __init__(self, name: str, child: Behaviour, *, seconds: Number, clock: Clock) -> None:
        """Rest for a number of seconds on the clock."""
        super().__init__(name, child)
        self._asked, self._clock = seconds, clock
        self._seconds = 0.0
        self._ready_s: float | None = None

    def initialise(self) -> None:
        """Take the number as it is now."""
        self._seconds = number(self._asked)

    def before(self) -> Status | None:
        """Fail while it rests."""
        if self._ready_s is None or self.status is Status.RUNNING:
            return None
        left_s = self._ready_s - self._clock.now_s()
        return self.fail("cooldown", f"rests for another {left_s:g} s") if left_s > 0.0 else None

    def update(self) -> Status:
        """Begin to rest when the child has finished."""
        if self.decorated.status is not Status.RUNNING:
            self._ready_s = self._clock.now_s() + self._seconds
        return self.decorated.status


class WhileRunning(Gated):
    """Answers for a child that runs, and lets it run on.

    py_trees halts the child with every such answer and starts it again (trap e8). Here it goes
    on when the next tick reaches it, and is halted by the first tick that does not.
    """

    MEMORY = ("_reached",)

    def __init__(self, name: str, child: Behaviour, *, says: Status) -> None:
        """Answer `says` while the child runs."""
        super().__init__(name, child)
        self._says = says
        self._reached = False

    def update(self) -> Status:
        """Return the answer of the child, or the one for a child that runs."""
        self._reached = True
        status: Status = self.decorated.status
        return self._says if status is Status.RUNNING else status

    def stop(self, new_status: Status) -> None:
        """End with a status; only a halt reaches the child."""
        if new_status is Status.INVALID:
            super().stop(new_status)
            return
        self.terminate(new_status)
        self.status = new_status

    def is_left(self) -> bool:
        """Return whether its child runs though the tick that ends now has not reached it."""
        reached, self._reached = self._reached, False
        return not reached and bool(self.decorated.status is Status.RUNNING)


class ForEach(Gated):
    """Runs the child once for each item of a list, one item in a tick at most."""

    MEMORY = ("_left",)

    def __init__(
        self, name: str, path: str, child: Behaviour, *, item: str, items: Value, scope: Scope
    ) -> None:
        """Put each of `items` under the key `item` in turn."""
        super().__init__(name, child)
        self._path, self._item, self._items, self._scope = path, item, items, scope
        self._left: list[object] = []

    def initialise(self) -> None:
        """Take the list as it is now.

        Raises:
            InputError: It is no list.
        """
        items = evaluate(self._items, self._scope)
        if isinstance(items, (str, bytes)) or not hasattr(items, "__iter__"):
            raise InputError(f"for_each: expected a list, got {items!r}")
        self._left = list(items)

    def before(self) -> Status | None:
        """Succeed when there is nothing left; otherwise show the child the next item."""
        if self.status is Status.RUNNING and self.decorated.status is Status.RUNNING:
            return None
        if not self._left:
            return Status.SUCCESS
        self._scope.write(self._item, self._left.pop(0), self._path)
        return None

    def update(self) -> Status:
        """Go on to the next item when the child has succeeded."""
        done = self.decorated.status is Status.SUCCESS
        return Status.RUNNING if done and self._left else self.decorated.status


def failure_codes(node: Behaviour) -> Iterator[str]:
    """Yield the codes of the reasons for which a node has just failed."""
    if node.status is not Status.FAILURE:
        return
    outcome = getattr(node, "outcome", None)
    if isinstance(outcome, Outcome) and outcome.reason is not None:
        yield outcome.reason.code
    for child in node.children:
        yield from failure_codes(child)
