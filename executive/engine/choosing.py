"""Nodes that pick one of several branches: `if_then_else`, `switch` and their kin.

Those with a memory pick once and stay with the branch until it has finished; the others pick
anew in every tick and halt the branch that is no longer the one.
"""

from abc import abstractmethod
from collections.abc import Iterator, Sequence

from py_trees.behaviour import Behaviour
from py_trees.common import Status
from py_trees.composites import Composite

from executive.core.outcome import Outcome, failure
from executive.engine.cases import case_of
from executive.engine.expression import Expression
from executive.engine.scope import Scope


class Chooser(Composite):
    """Base of the nodes that pick a branch.

    Attributes:
        status: Answer of the last tick.
        outcome: Why it failed by itself, None where a branch decided.
    """

    MEMORY = ("_picked", "_branch")

    status: Status

    def __init__(self, name: str, children: Sequence[Behaviour], *, memory: bool) -> None:
        """Pick among children, once or in every tick."""
        super().__init__(name, list(children))
        self.outcome: Outcome | None = None
        self._memory, self._picked = memory, False
        self._branch: int | None = None

    def tick(self) -> Iterator[Behaviour]:
        """Pick, and tick what was picked."""
        if self.status is not Status.RUNNING:
            self.begin()
            self._stop_all_but(())
        if not (self._memory and self._picked):
            condition = self.condition()
            if condition is not None:
                yield from condition.tick()
            self.decide()
            self._stop_all_but((condition, self.branch()))
        branch = self.branch()
        if branch is not None:
            yield from branch.tick()
        self.finish(self.answer())
        yield self

    def begin(self) -> None:
        """Forget what was picked."""
        self.outcome, self._picked, self._branch = None, False, None

    def condition(self) -> Behaviour | None:
        """Return the child that is asked before a branch is picked, if there is one."""
        return None

    @abstractmethod
    def pick(self) -> int | None:
        """Return the index of the branch; None where there is none for what was found."""

    def branch(self) -> Behaviour | None:
        """Return the branch that was picked."""
        return None if self._branch is None else self.children[self._branch]

    def decide(self) -> None:
        """Pick a branch, unless the condition still runs."""
        condition = self.condition()
        runs = condition is not None and condition.status is Status.RUNNING
        self._picked = not runs
        self._branch = None if runs else self.pick()

    def answer(self) -> Status:
        """Return the answer of a tick in which the branch had its turn."""
        if not self._picked:
            return Status.RUNNING
        branch = self.branch()
        if branch is None:
            return Status.FAILURE
        self.outcome = None
        status: Status = branch.status
        return status

    def finish(self, status: Status) -> None:
        """Take the answer."""
        if status is Status.RUNNING:
            self.status = status
        else:
            self.stop(status)
        self.current_child = self.children[self._branch or 0]

    def _stop_all_but(self, kept: Sequence[Behaviour | None]) -> None:
        for child in self.children:
            if child not in kept and child.status is not Status.INVALID:
                child.stop(Status.INVALID)


class IfThenElse(Chooser):
    """The second child where the first succeeds, the third where it fails."""

    def condition(self) -> Behaviour:
        """Return the first child."""
        first: Behaviour = self.children[0]
        return first

    def pick(self) -> int | None:
        """Return the branch; without a third child, a condition that fails is a failure."""
        branch = 1 if self.children[0].status is Status.SUCCESS else 2
        return branch if branch < len(self.children) else None


class Switch(Chooser):
    """The child whose case is the value of an expression."""

    def __init__(
        self,
        name: str,
        children: Sequence[Behaviour],
        *,
        on: Expression,
        cases: Sequence[str],
        scope: Scope,
        memory: bool,
    ) -> None:
        """Compare an expression with cases; a child more than cases is for all others."""
        super().__init__(name, children, memory=memory)
        self._on, self._cases, self._scope = on, tuple(cases), scope

    def pick(self) -> int | None:
        """Return the branch of the value."""
        value = self._on.evaluate(self._scope)
        case = case_of(self._cases, value)
        index = len(self._cases) if case is None else case
        if index < len(self.children):
            return index
        self.outcome = failure("switch.no_case", f"{self._on.text} is {value!r}")
        return None
