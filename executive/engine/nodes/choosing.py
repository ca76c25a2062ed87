"""Nodes that pick one of several branches: `if_then_else`, `switch` and their kin.

Those with a memory pick once and stay with the branch until it has finished; the others pick
anew in every tick and halt the branch that is no longer the one.
"""

from abc import abstractmethod
from collections.abc import Iterable, Iterator, Sequence
from typing import ClassVar

from py_trees.behaviour import Behaviour
from py_trees.common import Status
from py_trees.composites import Composite

from executive.core.outcome import Outcome, failure
from executive.engine.language.cases import case_of
from executive.engine.language.expression import Expression
from executive.engine.language.scope import Scope


class Chooser(Composite):
    """Base of the nodes that pick a branch.

    Attributes:
        status: Answer of the last tick.
        outcome: Why it failed by itself, None where a branch decided.
        picked: Whether a branch was picked in this activation, be it none.
        branch: Index of the branch; None where there is none.
    """

    ASKS: ClassVar = False
    """Whether the first child is asked before a branch is picked."""
    MEMORY: ClassVar = ("picked", "branch")

    status: Status

    def __init__(self, name: str, children: Sequence[Behaviour], *, memory: bool) -> None:
        """Pick among children, once or in every tick."""
        super().__init__(name, list(children))
        self.outcome: Outcome | None = None
        self.picked = False
        self.branch: int | None = None
        self._memory = memory

    def tick(self) -> Iterator[Behaviour]:
        """Pick, and tick what was picked."""
        if self.status is not Status.RUNNING:
            self.begin()
            self._stop(range(len(self.children)))
        if self.picks():
            if self.ASKS:
                yield from self.children[0].tick()
            self._stop(self.decide())
        if self.branch is not None:
            yield from self.children[self.branch].tick()
        status = self.answer()
        if status is Status.RUNNING:
            self.status = status
        else:
            self.stop(status)
        yield self

    def begin(self) -> None:
        """Forget what was picked."""
        self.outcome, self.picked, self.branch = None, False, None

    def picks(self) -> bool:
        """Return whether a branch is to be picked in this tick."""
        return not (self._memory and self.picked)

    @abstractmethod
    def pick(self) -> int | None:
        """Return the index of the branch; None where there is none for what was found."""

    def decide(self) -> list[int]:
        """Pick a branch, unless the first child still runs; return which children that ends."""
        runs = self.ASKS and self.children[0].status is Status.RUNNING
        self.picked = not runs
        self.branch = None if runs else self.pick()
        kept = (0, self.branch) if self.ASKS else (self.branch,)
        return [i for i in range(len(self.children)) if i not in kept]

    def answer(self) -> Status:
        """Return the answer of a tick in which the branch had its turn."""
        self.current_child = self.children[self.branch or 0]
        if not self.picked:
            return Status.RUNNING
        if self.branch is None:
            return Status.FAILURE
        self.outcome = None
        status: Status = self.children[self.branch].status
        return status

    def _stop(self, indices: Iterable[int]) -> None:
        for i in indices:
            if self.children[i].status is not Status.INVALID:
                self.children[i].stop(Status.INVALID)


class IfThenElse(Chooser):
    """The second child where the first succeeds, the third where it fails."""

    ASKS: ClassVar = True

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
