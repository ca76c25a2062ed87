"""Ticks a tree once and says what that changed.

Only what can have changed is looked at: nodes that answered, nodes that were stopped (one that
another node halts is never visited, trap e16), and nodes below those that py_trees ticks by
itself. What happens between ticks is seen by `record_end`.
"""

import time
import traceback
from collections.abc import Iterator, Sequence

from py_trees.behaviour import Behaviour
from py_trees.common import Status as TreeStatus

from executive.core.errors import NodeError
from executive.core.outcome import Outcome, Reason
from executive.engine.checkpoints.past import Past
from executive.engine.nodes.builder import BuiltTree
from executive.engine.nodes.calls import Event
from executive.engine.nodes.interception import Interceptor, chained
from executive.engine.nodes.raising import failing
from executive.engine.nodes.ticking import NODE_STATUS, DirectTicks
from executive.engine.ticks import (
    RUNNER,
    Halt,
    NodeFault,
    NodeOutcome,
    NodeStatus,
    Tick,
)

# What py_trees makes of `update` returning None or a word (trap e13).
_NO_ANSWER = "update() gave no status; expected Status.RUNNING, SUCCESS or FAILURE"
INVALID, RUNNING = NodeStatus.INVALID, NodeStatus.RUNNING


_Moves = tuple[tuple[int, ...], tuple[tuple[int, NodeStatus], ...], tuple[Halt, ...]]


class TreeProbe:
    """Watches one tree from its first tick to its last."""

    def __init__(self, tree: BuiltTree, intercept: Interceptor | None = None) -> None:
        """Begin with what the nodes are before the first tick.

        Args:
            tree: The tree.
            intercept: What stands between each node and its parent.
        """
        self._tree = tree
        self.behaviours: tuple[Behaviour, ...] = tuple(node.behaviour for node in tree.nodes)
        self._direct = self._calls(intercept)
        self._index = {id(behaviour): i for i, behaviour in enumerate(self.behaviours)}
        self._parents = tuple(node.parent for node in tree.nodes)
        self._statuses = [INVALID] * len(self.behaviours)
        self._events: list[Event] = []
        self._visited: tuple[int, ...] = ()
        self._plain = False
        self._inner = tuple(bool(behaviour.children) for behaviour in self.behaviours)
        # Other inner nodes never decide anything themselves.
        self._speaking = tuple(
            None if behaviour.children and not hasattr(behaviour, "outcome") else behaviour
            for behaviour in self.behaviours
        )
        self._told: dict[int, tuple[int, NodeStatus, Reason | None]] = {}
        self._earlier: tuple[Event, ...] = ()
        self.reasons: dict[int, Reason] = {}
        self.raised: Behaviour | None = None

    def go_on(self, past: Past) -> None:
        """Begin with a tick that was under way instead of with the first one."""
        self._statuses, self._earlier = list(past.statuses), past.events
        self._told, self.reasons = dict(past.told), dict(past.reasons)

    def so_far(self) -> tuple[tuple[Event, ...], tuple[NodeOutcome, ...]]:
        """Return what was answered in the tick that is under way, and how nodes ended in it."""
        events = (*self._earlier, *self._direct.log.events)
        ends = (
            NodeOutcome(node, status, _reason(self.behaviours[node]))
            for node, status in events
            if self._speaking[node] is not None and status not in (RUNNING, INVALID)
        )
        return events, tuple(ends)

    def intercept_with(self, intercept: Interceptor | None) -> None:
        """Put something else between nodes and their parents, from the next tick on."""
        self._direct = self._calls(intercept)
        self._plain = False

    def _calls(self, intercept: Interceptor | None) -> DirectTicks:
        around = () if intercept is None else (intercept,)
        if self._tree.supervision.on_error == "fail":
            paths = [node.path for node in self._tree.nodes]
            around = (failing(paths, self._tree.supervision), *around)
        return DirectTicks(self._tree.root, self.behaviours, chained(around))

    @property
    def answer(self) -> NodeStatus:
        """What the root answered in the last tick."""
        return NODE_STATUS[self._tree.root.status]

    @property
    def answers(self) -> dict[int, NodeStatus]:
        """What each node that was visited in the last tick answered, by index, in order."""
        broken = {self._index.get(id(node)) for node in self._direct.log.broken}
        return {
            node: status for node, status in self._events if status is not INVALID or node in broken
        }

    def tick(self, number: int, time_s: float) -> tuple[Tick, NodeError | None]:
        """Tick the tree once.

        Returns:
            What it changed, and the error when a node raised.
        """
        log, error = self._direct.log, None
        began_s = time.perf_counter()
        try:
            self._direct.tick()
        except BaseException as cause:
            raising = self._remember_raising()
            if not isinstance(cause, Exception):
                raise
            error = self.error_of(raising, number, cause)
        duration_s = time.perf_counter() - began_s
        if log.broken and error is None:
            error = self.error_of(log.broken[0], number, TypeError(_NO_ANSWER))
        faults = () if error is None else (fault_of(error),)
        return self._record(number, time_s, duration_s, faults), error

    def record_end(self, number: int, time_s: float, errors: Sequence[Exception]) -> Tick:
        """Return what the runner stopped since the last tick, as a tick without visits."""
        self._direct.log.clear()
        self._look_everywhere()
        return self._record(number, time_s, 0.0, tuple(fault_of(error) for error in errors))

    def _record(
        self, number: int, time_s: float, duration_s: float, faults: tuple[NodeFault, ...]
    ) -> Tick:
        if faults:
            self._look_everywhere()
        visited, changes, halts = self._moves()
        return Tick(
            number,
            time_s,
            duration_s,
            visited=visited,
            changes=changes,
            halts=halts,
            outcomes=tuple(self._outcomes(number)),
            writes=tuple(self._tree.blackboard.drain_writes()),
            faults=faults,
        )

    def _look_everywhere(self) -> None:
        self._direct.log.unseen.update(range(len(self.behaviours)))

    def _moves(self) -> _Moves:
        """Return visits, changes and halts of the tick that the log is about."""
        log = self._direct.log
        if self._earlier:
            log.events[:0], self._earlier = self._earlier, ()
        if self._plain and not log.unseen and log.events == self._events:
            return self._visited, (), ()  # the same answers as in the tick before
        self._events = events = log.events.copy()
        after = dict(events)
        once = len(after) == len(events) and INVALID not in after.values()
        self._plain = once and not log.unseen
        answers = after.copy() if once else self.answers
        self._visited = tuple(answers)
        after.update((i, NODE_STATUS[self.behaviours[i].status]) for i in log.unseen)
        before = self._statuses
        halted = [
            i
            for i, status in after.items()
            if status is INVALID and answers.get(i, before[i]) is RUNNING
        ]
        changes = sorted((i, status) for i, status in after.items() if before[i] is not status)
        for i, status in changes:
            before[i] = status
        halts = tuple(Halt(i, self._halted_by(i)) for i in sorted(halted))
        return self._visited, tuple(changes), halts

    def _halted_by(self, node: int) -> int:
        parent = self._parents[node]
        while parent is not None and self._statuses[parent] is INVALID:
            parent = self._parents[parent]
        return RUNNER if parent is None else parent

    def _outcomes(self, number: int) -> Iterator[NodeOutcome]:
        """Return how nodes ended that decided it themselves, unless that is no news.

        Conditions of a reactive branch answer the same in every tick; only their first
        answer is worth a record, the visits tell the rest.
        """
        told, before, speaking = self._told, number - 1, self._speaking
        for node, status in self._events:
            behaviour = speaking[node]
            if status is RUNNING or status is INVALID or behaviour is None:
                continue
            reason = _reason(behaviour)
            if reason is not None:
                self.reasons[node] = reason
            elif self.reasons.pop(node, None) is None and self._inner[node]:
                continue
            last = told.get(node)
            told[node] = number, status, reason
            if (
                last is None
                or last[0] != before
                or last[1] is not status
                or not _alike(last[2], reason)
            ):
                yield NodeOutcome(node, status, reason)

    def error_of(self, behaviour: Behaviour, number: int, cause: BaseException) -> NodeError:
        """Return what a node raised, with the path and type of the node and the tick."""
        if isinstance(cause, NodeError):
            return cause
        node = self._index.get(id(behaviour))
        if node is None:
            return NodeError(behaviour.name, type(behaviour).__name__, number, cause)
        return NodeError(self._tree.nodes[node].path, self._tree.nodes[node].type, number, cause)

    def _remember_raising(self) -> Behaviour:
        """Return the node that raised, and remember it if it still has to be stopped."""
        log = self._direct.log
        behaviour = log.raised or self._tree.root
        if log.terminating:
            # It has had its one call; the status says that to whoever stops the rest.
            behaviour.status = TreeStatus.INVALID
        else:
            self.raised = behaviour
        return behaviour


def _reason(behaviour: Behaviour) -> Reason | None:
    outcome = getattr(behaviour, "outcome", None)
    return outcome.reason if isinstance(outcome, Outcome) else None


def _alike(one: Reason | None, other: Reason | None) -> bool:
    if one is None or other is None:
        return one is other
    return (one.code, one.text) == (other.code, other.text)


def fault_of(error: Exception) -> NodeFault:
    """Return the record of an error; one of the cell or an observer has no path."""
    cause: BaseException = error
    path = node_type = ""
    if isinstance(error, NodeError):
        path, node_type, cause = error.path, error.node_type, error.__cause__ or error
    text = "".join(traceback.format_exception(cause))
    return NodeFault(path, node_type, f"{type(cause).__name__}: {cause}", text)
