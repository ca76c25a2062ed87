"""Finds reads of keys that nothing can have written yet.

The tree is walked in the order of its ticks with the set of keys that may have been written
so far, once for success and once for failure. Inside a loop a key may also come from an
earlier round; not so where every writer in the loop stands behind the read in a sequence that
cannot be passed without it.
"""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from executive.engine.language.block_models import (
    CasesBody,
    ForceFailureBody,
    ForceSuccessBody,
    ForEachBody,
    IfThenElseBody,
    InverterBody,
    ParallelBody,
    ReactiveSelectorBody,
    ReactiveSequenceBody,
    ReactiveSwitchBody,
    RepeatBody,
    RetryBody,
    RunningIsFailureBody,
    RunningIsSuccessBody,
    SelectorBody,
    SequenceBody,
    WhileDoElseBody,
)
from executive.engine.language.node_models import SetNode, UnsetNode
from executive.engine.language.outline import NodeSpec
from executive.engine.loading.wiring import Use, Wiring

Keys = frozenset[str]
Complain = Callable[[NodeSpec, Use, str], None]

_LOOPS = (
    *(RetryBody, RepeatBody, ForEachBody, ReactiveSequenceBody, ReactiveSelectorBody),
    *(WhileDoElseBody, ReactiveSwitchBody),
)
_LATER = ("on_success", "on_failure", "on_halt", "finally")
"""Where a node reads keys when it ends."""
_PASSING = (RunningIsSuccessBody, RunningIsFailureBody)
_SKIPPING = (ForEachBody, ForceSuccessBody, InverterBody, ParallelBody, CasesBody, *_PASSING)
"""Kinds that may succeed though not everything in them was reached."""


@dataclass(frozen=True, slots=True)
class _Rounds:
    """How many nodes of the loops around here write each key.

    Attributes:
        all: All of them.
        must: Without those that no round can reach before this place was passed.
    """

    all: Counter[str] = field(default_factory=Counter)
    must: Counter[str] = field(default_factory=Counter)

    def entered(self, inside: Counter[str]) -> "_Rounds":
        return _Rounds(self.all + inside, self.must + inside)

    def before(self, later: Counter[str]) -> "_Rounds":
        return _Rounds(self.all, self.must - later) if self.must else self

    def uncertain(self) -> "_Rounds":
        return _Rounds(self.all, self.all)


def find_early_reads(
    root: NodeSpec, wirings: Mapping[NodeSpec, Wiring], inputs: Keys, complain: Complain
) -> None:
    """Call `complain` with the node, the use and the key of every read that comes too early.

    Args:
        root: Root of the tree.
        wirings: What each node reads and writes.
        inputs: Keys that have a value from the start.
        complain: Told about each of them.
    """
    _Flow(wirings, complain).walk(root, inputs, _Rounds())


class _Flow:
    def __init__(self, wirings: Mapping[NodeSpec, Wiring], complain: Complain) -> None:
        self._wirings, self._complain = wirings, complain
        self._counted: dict[NodeSpec, Counter[str]] = {}

    def walk(self, node: NodeSpec, known: Keys, rounds: _Rounds) -> tuple[Keys, Keys]:
        """Return the keys that may be written after a success, and after a failure."""
        wiring = self._wirings[node]
        ends = frozenset(gives.key for gives in wiring.ends)
        if node.model.unless is not None:
            rounds = rounds.uncertain()
        known = self._read(wiring, known, rounds)
        if isinstance(node.model, _LOOPS):
            rounds = rounds.entered(self._counts(node))
        if isinstance(node.model, _SKIPPING):
            rounds = rounds.uncertain()
        inside = known | ends if isinstance(node.model, ForEachBody) else known
        success, failure = self._children(node, inside, rounds)
        if isinstance(node.model, UnsetNode):
            success -= {*node.model.keys}
        return success | ends.union(gives.key for gives in wiring.gives), failure | ends

    def _read(self, wiring: Wiring, known: Keys, rounds: _Rounds) -> Keys:
        starts = frozenset(gives.key for gives in wiring.ends if gives.at[0] == "on_start")
        for use in wiring.uses:
            if use.at[0] in _LATER:
                continue
            if use.at[0] not in wiring.node.model.guards:
                known |= starts  # set when the guards have let it pass
            if not use.optional:
                for key in sorted(use.value.reads):
                    if key not in known and not rounds.must[key]:
                        self._complain(wiring.node, use, key)
            if isinstance(wiring.node.model, SetNode) and use.at[0] == "set":
                known |= {use.at[1]}  # what is set first can be used next
        return known | starts

    def _children(self, node: NodeSpec, known: Keys, rounds: _Rounds) -> tuple[Keys, Keys]:
        model = node.model
        if isinstance(model, (SequenceBody, ReactiveSequenceBody)):
            return self._sequence(node, known, rounds)
        if isinstance(model, (SelectorBody, ReactiveSelectorBody)):
            failure, success = self._selector(node, known, rounds)
            return success, failure
        if isinstance(model, ParallelBody):
            return self._parallel(node, known, rounds)
        if isinstance(model, (IfThenElseBody, WhileDoElseBody)):
            return self._branches(node, known, rounds)
        if isinstance(model, CasesBody):
            return self._either(node.children, known, rounds)
        if not node.children:
            return known, known
        success, failure = self.walk(node.children[0], known, rounds)
        if isinstance(model, InverterBody):
            return failure, success
        if isinstance(model, (ForceSuccessBody, ForceFailureBody)):
            return success | failure, success | failure
        if isinstance(model, _PASSING):
            either = known.union(success, failure, self._counts(node))
            return either, either
        return success, failure | known

    def _sequence(self, node: NodeSpec, known: Keys, rounds: _Rounds) -> tuple[Keys, Keys]:
        failure = known
        later: Counter[str] = Counter()
        for child in node.children:
            later.update(self._counts(child))
        for child in node.children:
            later.subtract(self._counts(child))
            known, failed = self.walk(child, known, rounds.before(later))
            failure |= failed
        return known, failure

    def _selector(self, node: NodeSpec, known: Keys, rounds: _Rounds) -> tuple[Keys, Keys]:
        success: Keys = frozenset()
        for i, child in enumerate(node.children):
            succeeded, known = self.walk(child, known, rounds.uncertain() if i else rounds)
            success |= succeeded
        return known, success

    def _branches(self, node: NodeSpec, known: Keys, rounds: _Rounds) -> tuple[Keys, Keys]:
        condition, then, *other = node.children
        known, unknown = self.walk(condition, known, rounds)
        success, failure = self.walk(then, known, rounds.uncertain())
        if not other:
            return success, failure | unknown
        succeeded, failed = self.walk(other[0], unknown, rounds.uncertain())
        return success | succeeded, failure | failed

    def _either(
        self, children: Sequence[NodeSpec], known: Keys, rounds: _Rounds
    ) -> tuple[Keys, Keys]:
        success: Keys = frozenset()
        failure = known
        for child in children:
            succeeded, failed = self.walk(child, known, rounds)
            success |= succeeded
            failure |= failed
        return success, failure

    def _parallel(self, node: NodeSpec, known: Keys, rounds: _Rounds) -> tuple[Keys, Keys]:
        counts = [self._counts(child) for child in node.children]
        after = known.union(*counts)
        for i, child in enumerate(node.children):
            others = known.union(*counts[:i], *counts[i + 1 :])
            self.walk(child, others, rounds)
        return after, after

    def _counts(self, node: NodeSpec) -> Counter[str]:
        if node not in self._counted:
            self._counted[node] = Counter(
                gives.key for below in node.walk() for gives in self._wirings[below].written
            )
        return self._counted[node]
