"""Injects faults into one run: between nodes and their parents, and between nodes and keys.

Nothing is changed in a skill: a node that is to fail, hang or raise is not ticked at all, and a
write is changed on its way to the blackboard. Nodes without a fault are ticked as ever.
"""

from collections.abc import Callable, Sequence
from fnmatch import fnmatchcase
from typing import Any

from py_trees.common import Status

from executive.core.errors import CellwrightError, InputError
from executive.core.outcome import RUNNING, failure
from executive.core.outcome import Status as Answer
from executive.core.world import StreamMessage
from executive.engine.blackboard import Write
from executive.engine.faults.armed import Armed
from executive.engine.faults.grammar import Injection, Kind
from executive.engine.faults.key_types import (
    KnownKey,
    WrongValue,
    instead_of,
    keys_meant,
    known_keys,
    wrong_values,
)
from executive.engine.language.node_patterns import matching
from executive.engine.loading.loader import Program
from executive.engine.nodes.builder import BuiltTree
from executive.engine.nodes.calls import TickCall
from executive.engine.nodes.interception import Junction
from executive.engine.nodes.leaf import Leaf
from executive.engine.recording.messages import InjectedReport
from executive.engine.running.interventions import InterventionLog
from executive.engine.ticks import RUNNER, Tick

INJECTED = "injected.failure"
"""Reason code of a failure that was injected."""
BY = "inject"


class InjectedError(CellwrightError):
    """An exception that was injected."""


class Injector:
    """All faults of one run; the run's runner takes `intercept`, `interventions` and itself."""

    def __init__(
        self, tree: BuiltTree, program: Program, injections: Sequence[Injection], *, seed: int
    ) -> None:
        """Arm a tree that has not been ticked.

        Args:
            tree: The tree.
            program: What it was built from.
            injections: What is to happen; of two for one activation or write the first does.
            seed: Seed of the run, for those that happen by chance.

        Raises:
            InputError: A fault means no node or no key of this tree, or its value does not fit.
        """
        self.interventions = InterventionLog()
        self._tree = tree
        self._armed = [Armed(injection, seed) for injection in injections]
        self._tick = 0
        self._faulty: dict[int, _FaultyNode] = {}
        keys: list[KnownKey] = []
        of_keys = []
        for armed in self._armed:
            try:
                if armed.injection.of_key:
                    keys = keys or list(known_keys(program))
                    of_keys.append((armed, _key_values(armed.injection, keys)))
                else:
                    self._arm_nodes(armed)
            except InputError as error:
                raise InputError(f"fault {armed.injection.text!r}: {error}") from None
        if of_keys:
            tree.blackboard.filter_with(_FaultyKeys(of_keys, tree, self._note))

    def intercept(self, junction: Junction) -> TickCall:
        """Return the call that a parent makes instead of ticking a node; an `Interceptor`."""
        faulty = self._faulty.get(junction.index)
        return junction.tick if faulty is None else faulty.between(junction)

    def on_tick(self, tick: Tick) -> None:
        """Take note of a tick that is over."""
        self._tick = tick.number + 1

    def on_streams(self, messages: Sequence[StreamMessage]) -> None:
        """Take what the cell streamed; nothing to do."""

    def reports(self) -> tuple[InjectedReport, ...]:
        """Return what came of each fault, in the order of their texts."""
        return tuple(armed.report() for armed in self._armed)

    def _arm_nodes(self, armed: Armed) -> None:
        found = matching(self._tree.nodes, armed.injection.target)
        leaves = {index for index in found if not self._tree.nodes[index].behaviour.children}
        for index in sorted(leaves or found):
            if index not in self._faulty:
                self._faulty[index] = _FaultyNode(self._tree, index, self._note)
            self._faulty[index].armed.append(armed)
            node: Any = self._tree.nodes[index].behaviour
            if not hasattr(node, "outcome"):
                node.outcome = None  # else the reason would have no place

    def _note(self, armed: Armed, place: str, node: int, what: str, answer: Answer | None) -> None:
        if what:
            armed.note(place, self._tick)
        said = what or f"still injected: {armed.injection.text}"
        self.interventions.note(self._tick, node, said, BY, answer)


_Note = Callable[[Armed, str, int, str, Answer | None], None]


def _key_values(injection: Injection, known: list[KnownKey]) -> list[WrongValue]:
    keys = keys_meant(injection.target, known)
    return wrong_values(injection.value, keys) if injection.kind is Kind.VALUE else []


class _FaultyNode:
    """A node that has faults; what it remembers outlives a change of what stands around it."""

    def __init__(self, tree: BuiltTree, index: int, note: _Note) -> None:
        self._tree, self._index, self._note = tree, index, note
        self._path: str = tree.nodes[index].path
        self._node: Any = tree.nodes[index].behaviour
        self.armed: list[Armed] = []
        self._activations = 0
        self._acting: Armed | None = None
        self._due_s = 0.0

    def between(self, junction: Junction) -> TickCall:
        return lambda: self._tick(junction)

    def _tick(self, junction: Junction) -> Status:
        first = self._node.status is not Status.RUNNING
        if first:
            self._begin()
        acting = self._acting
        if acting is None:
            return junction.tick()
        what = f"injected: {acting.injection.text}" if first else ""
        match acting.injection.kind:
            case Kind.FAIL:
                self._tell(what, Answer.FAILURE)
                return junction.answer(failure(INJECTED, f"by {acting.injection.text!r}"))
            case Kind.RAISE:
                self._tell(what, None)
                return self._raise(junction)
            case Kind.DELAY if not first and self._tree.clock.now_s() >= self._due_s:
                self._acting = None
                self._node.status = Status.INVALID  # it has yet to be started
                return junction.tick()
        self._tell(what, Answer.RUNNING)
        return junction.answer(RUNNING)

    def _begin(self) -> None:
        self._activations += 1
        if self._node.children:
            self._node.outcome = None  # what was injected last time
        happening = (one for one in self.armed if one.happens(self._path, self._activations))
        self._acting = next(happening, None)
        if self._acting is not None:
            self._due_s = self._tree.clock.now_s() + self._acting.injection.seconds

    def _tell(self, what: str, answer: Answer | None) -> None:
        assert self._acting is not None
        self._note(self._acting, self._path, self._index, what, answer)

    def _raise(self, junction: Junction) -> Status:
        assert self._acting is not None
        error = InjectedError(f"by {self._acting.injection.text!r}")
        try:
            if not isinstance(self._node, Leaf):
                raise error
            return junction.answer(self._node.raised(error))
        except InjectedError:
            junction.log.note_raised(self._node, terminating=False)
            raise


class _FaultyKeys:
    """Changes writes on their way to the blackboard."""

    def __init__(
        self, faults: list[tuple[Armed, list[WrongValue]]], tree: BuiltTree, note: _Note
    ) -> None:
        self._faults, self._note = faults, note
        self._nodes = {node.path: node.index for node in tree.nodes}
        self._of_key: dict[str, list[tuple[Armed, list[WrongValue]]]] = {}
        self._count: dict[str, int] = {}
        self._last: dict[str, Any] = {}

    def __call__(self, write: Write) -> Write | None:
        faults = self._of_key.get(write.key)
        if faults is None:
            faults = [one for one in self._faults if _means(one[0].injection.target, write.key)]
            self._of_key[write.key] = faults
        if not faults:
            return write
        self._count[write.key] = count = self._count.get(write.key, 0) + 1
        changed: Write | None = write
        for armed, values in faults:
            if self._can(armed, write.key) and armed.happens(write.key, count):
                node = self._nodes.get(write.writer, RUNNER)
                what = f"injected: {armed.injection.text} ({write.key})"
                self._note(armed, write.key, node, what, None)
                changed = self._changed(armed.injection.kind, write, values)
                break
        if changed is not None:
            self._last[write.key] = changed.value
        return changed

    def _can(self, armed: Armed, key: str) -> bool:
        return armed.injection.kind is not Kind.STALE or key in self._last

    def _changed(self, kind: Kind, write: Write, values: list[WrongValue]) -> Write | None:
        if kind is Kind.DROP:
            return None
        value = self._last[write.key] if kind is Kind.STALE else instead_of(write.value, values)
        return Write(write.key, value, write.writer)


def _means(pattern: str, key: str) -> bool:
    return fnmatchcase(key, pattern) or fnmatchcase(key, f"*:{pattern}")
