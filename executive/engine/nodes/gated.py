"""The base of our nodes with one child: they may answer without ticking it."""

from collections.abc import Iterator

from py_trees.behaviour import Behaviour
from py_trees.common import Status
from py_trees.decorators import Decorator

from executive.core.outcome import Outcome, failure


class Gated(Decorator):
    """A decorator that may answer without ticking its child.

    Attributes:
        status: Answer of the last tick.
        outcome: Why it answered by itself, None where the child decided.
    """

    status: Status

    def __init__(self, name: str, child: Behaviour) -> None:
        """Decorate a child."""
        super().__init__(name, child)
        self.outcome: Outcome | None = None

    def before(self) -> Status | None:
        """Return the answer of this tick, or None to tick the child."""
        return None

    def tick(self) -> Iterator[Behaviour]:
        """Ask `before`, and `update` if that left it to the child."""
        if self.status is not Status.RUNNING:
            self.outcome = None
            self.initialise()
        status = self.before()
        if status is None:
            yield from self.decorated.tick()
            status = self.update()
        if status is not Status.RUNNING:
            self.stop(status)
        self.status = status
        yield self

    def update(self) -> Status:
        """Return the answer after the child was ticked."""
        return self.decorated.status

    def fail(self, code: str, text: str) -> Status:
        """Answer with a failure of its own."""
        self.outcome = failure(code, text)
        return Status.FAILURE
