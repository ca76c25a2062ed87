"""A node around another one that notes in keys what it answers."""

from dataclasses import replace

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.engine.language.counts import NodeCounts
from executive.engine.language.scope import Scope
from executive.engine.nodes.gated import Gated
from executive.engine.ticks import NodeStatus

_COUNTERS = {Status.RUNNING: "running", Status.SUCCESS: "successes", Status.FAILURE: "failures"}


class Observe(Gated):
    """Answers what the child answers, and writes it to keys."""

    MEMORY = ("_counts",)

    def __init__(
        self,
        name: str,
        path: str,
        child: Behaviour,
        *,
        status: str | None,
        counts: str | None,
        scope: Scope,
    ) -> None:
        """Observe a child.

        Args:
            name: Name of the node.
            path: Its path, which is the writer of the keys.
            child: The child.
            status: Key for its status, None for none.
            counts: Key for its counts, None for none.
            scope: Names of its tree.
        """
        super().__init__(name, child)
        self._path, self._scope = path, scope
        self._status_key, self._counts_key = status, counts
        self._counts = NodeCounts()

    def update(self) -> Status:
        """Count and note the answer of the child."""
        status = self.decorated.status
        counter = _COUNTERS[status]
        self._note(
            status,
            replace(
                self._counts,
                ticks=self._counts.ticks + 1,
                **{counter: getattr(self._counts, counter) + 1},
            ),
        )
        return status

    def terminate(self, new_status: Status) -> None:
        """Note a halt; one of a child that does not run is none."""
        if new_status is Status.INVALID and self.status is Status.RUNNING:
            self._note(Status.INVALID, replace(self._counts, halts=self._counts.halts + 1))

    def _note(self, status: Status, counts: NodeCounts) -> None:
        self._counts = counts
        if self._status_key is not None:
            self._scope.write(self._status_key, NodeStatus(status.value), self._path)
        if self._counts_key is not None:
            self._scope.write(self._counts_key, counts, self._path)
