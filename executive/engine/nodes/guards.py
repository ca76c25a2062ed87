"""The node around one with `if`, `unless`, `while`, `on_...` or `finally`."""

from collections.abc import Mapping

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.engine.language.expression import Expression
from executive.engine.language.scope import Scope
from executive.engine.nodes.gated import Gated
from executive.engine.nodes.leaf import answer, assign

_ENDS = {
    Status.SUCCESS: "on_success",
    Status.FAILURE: "on_failure",
    Status.INVALID: "on_halt",
}


class Guard(Gated):
    """Conditions and assignments around a node: `if`, `unless`, `while`, `on_...`, `finally`."""

    MEMORY = ("_starts",)

    def __init__(
        self,
        name: str,
        path: str,
        child: Behaviour,
        *,
        conditions: Mapping[str, Expression],
        assignments: Mapping[str, Mapping[str, Expression]],
        scope: Scope,
    ) -> None:
        """Guard a node.

        Args:
            name: Name of the node.
            path: Its path, which is the writer of its assignments.
            child: The node.
            conditions: Expressions by `if`, `unless`, `while`.
            assignments: Expressions by key, by `on_start`, `on_success`, ..., `finally`.
            scope: Names of its tree.
        """
        super().__init__(name, child)
        self._path, self._scope = path, scope
        self._conditions, self._assignments = conditions, assignments
        self._starts = False

    def initialise(self) -> None:
        """Note that the conditions of a start are due."""
        self._starts = True

    def before(self) -> Status | None:
        """Ask the conditions; those of a start only once."""
        starts, self._starts = self._starts, False
        if starts and not self._holds("if"):
            return Status.FAILURE
        if starts and "unless" in self._conditions and self._holds("unless"):
            self.outcome = None
            return Status.SUCCESS
        self.outcome = None
        if not self._holds("while"):
            return Status.FAILURE
        if starts:
            self._assign("on_start")
        return None

    def _holds(self, guard: str) -> bool:
        if guard not in self._conditions:
            return True
        self.outcome = answer(self._conditions[guard], self._scope)
        return self.outcome.reason is None

    def terminate(self, new_status: Status) -> None:
        """Set the keys that belong to how the node ends."""
        halted_idle = new_status is Status.INVALID and self.status is not Status.RUNNING
        if not halted_idle:
            self._assign(_ENDS[new_status])
            self._assign("finally")

    def _assign(self, when: str) -> None:
        assign(self._assignments.get(when, {}), self._scope, self._path)
