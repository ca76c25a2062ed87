"""All children at once, with policies that say when enough is enough.

py_trees' Parallel lets one failure beat every policy (trap e7) and knows no counts.
"""

from collections.abc import Iterator, Sequence

from py_trees.behaviour import Behaviour
from py_trees.common import Status
from py_trees.composites import Composite


class Parallel(Composite):
    """Ticks every child that has not finished, in order, in every tick.

    It succeeds when enough children have succeeded, also when enough have failed in the same
    tick. It fails when enough have failed; without a number for that, as soon as success is
    out of reach. When all have finished and neither holds, it fails.

    Attributes:
        status: Answer of the last tick.
    """

    MEMORY = ("_verdict",)
    status: Status

    def __init__(
        self,
        name: str,
        children: Sequence[Behaviour],
        *,
        succeed: int | frozenset[int],
        fail: int | None,
        wait: bool,
    ) -> None:
        """Set the policies.

        Args:
            name: Name of the node.
            children: The children.
            succeed: How many must succeed, or exactly which, by index.
            fail: How many failures make it fail; None for as soon as it cannot succeed.
            wait: Whether children that run when it is decided are waited for.
        """
        super().__init__(name, list(children))
        self._succeed, self._fail, self._wait = succeed, fail, wait
        self._verdict: Status | None = None

    def tick(self) -> Iterator[Behaviour]:
        """Tick the children that have not finished, then decide."""
        if self.status is not Status.RUNNING:
            self.begin()
            self._stop([child for child in self.children if child.status is not Status.INVALID])
        for child in self.children:
            if child.status not in (Status.SUCCESS, Status.FAILURE):
                yield from child.tick()
        status = self.decide()
        if status is Status.RUNNING:
            self.status = status
        else:
            self._stop([child for child in self.children if child.status is Status.RUNNING])
            self.stop(status)
        yield self

    def begin(self) -> None:
        """Forget what was decided."""
        self._verdict = None

    def decide(self) -> Status:
        """Return the answer of a tick in which every child has had its turn."""
        self._verdict = self._verdict or self._decide()
        running = [child for child in self.children if child.status is Status.RUNNING]
        self.current_child = running[0] if running else self.children[-1]
        return (
            Status.RUNNING if self._verdict is None or (self._wait and running) else self._verdict
        )

    def _stop(self, children: Sequence[Behaviour]) -> None:
        for child in children:
            child.stop(Status.INVALID)

    def _decide(self) -> Status | None:
        statuses = [child.status for child in self.children]
        if self._enough([status is Status.SUCCESS for status in statuses]):
            return Status.SUCCESS
        failures = statuses.count(Status.FAILURE)
        if self._fail is not None:
            hopeless = failures >= self._fail
        else:
            hopeless = not self._enough([status is not Status.FAILURE for status in statuses])
        return Status.FAILURE if hopeless or Status.RUNNING not in statuses else None

    def _enough(self, succeeded: list[bool]) -> bool:
        if isinstance(self._succeed, int):
            return sum(succeeded) >= self._succeed
        return all(succeeded[i] for i in self._succeed)
