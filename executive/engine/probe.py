"""Ticks a tree once and says what that changed.

Statuses are compared after the tick over all nodes of the table, not only over those that
were visited: a node that another one halts is never visited (trap e16).
"""

import time
import traceback
from collections.abc import Sequence

from py_trees.behaviour import Behaviour
from py_trees.common import Status as TreeStatus

from executive.core.errors import NodeError
from executive.core.outcome import Outcome, Reason
from executive.engine.builder import BuiltTree
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
_STATUS = {status: NodeStatus(status.value) for status in TreeStatus}


class TreeProbe:
    """Watches one tree from its first tick to its last."""

    def __init__(self, tree: BuiltTree) -> None:
        """Begin with what the nodes are before the first tick."""
        self._tree = tree
        self.behaviours: tuple[Behaviour, ...] = tuple(node.behaviour for node in tree.nodes)
        self._index = {id(behaviour): i for i, behaviour in enumerate(self.behaviours)}
        self._parents = tuple(node.parent for node in tree.nodes)
        self._before = [TreeStatus.INVALID] * len(self.behaviours)
        self._answers: dict[int, TreeStatus] = {}
        self._told: dict[int, tuple[int, TreeStatus, str]] = {}
        self.reasons: dict[int, Reason] = {}
        self.raised: Behaviour | None = None

    @property
    def answer(self) -> NodeStatus:
        """What the root answered in the last tick."""
        return _STATUS[self._tree.root.status]

    @property
    def answers(self) -> dict[int, NodeStatus]:
        """What each node that was visited in the last tick answered, by index, in order."""
        return {node: _STATUS[status] for node, status in self._answers.items()}

    def tick(self, number: int, time_s: float) -> tuple[Tick, NodeError | None]:
        """Tick the tree once.

        Returns:
            What it changed, and the error when a node raised.
        """
        began_s = time.perf_counter()
        self._answers, error = {}, None
        outcomes: list[NodeOutcome] = []
        try:
            for behaviour in self._tree.root.tick():
                node, status = self._index.get(id(behaviour)), behaviour.status
                if status is TreeStatus.INVALID and error is None:
                    error = self.error_of(behaviour, number, TypeError(_NO_ANSWER))
                if node is not None:
                    self._answers[node] = status
                    if status is not TreeStatus.RUNNING:
                        outcomes += self._outcome(node, behaviour)
        except BaseException as cause:
            raising = self._remember_raising(cause)
            if not isinstance(cause, Exception):
                raise
            error = self.error_of(raising, number, cause)
        duration_s = time.perf_counter() - began_s
        faults = () if error is None else (fault_of(error),)
        return self._record(number, time_s, duration_s, outcomes, faults), error

    def record_end(self, number: int, time_s: float, errors: Sequence[Exception]) -> Tick:
        """Return what the runner stopped since the last tick, as a tick without visits."""
        self._answers = {}
        return self._record(number, time_s, 0.0, [], tuple(fault_of(error) for error in errors))

    def _record(
        self,
        number: int,
        time_s: float,
        duration_s: float,
        outcomes: Sequence[NodeOutcome],
        faults: tuple[NodeFault, ...],
    ) -> Tick:
        before, after = self._before, [behaviour.status for behaviour in self.behaviours]
        self._before = after
        return Tick(
            number,
            time_s,
            duration_s,
            visited=tuple(self._answers),
            changes=tuple(
                (node, _STATUS[new])
                for node, (old, new) in enumerate(zip(before, after, strict=True))
                if old is not new
            ),
            halts=self._halts(before, after),
            outcomes=tuple(outcome for outcome in outcomes if self._is_news(number, outcome)),
            writes=tuple(self._tree.blackboard.drain_writes()),
            faults=faults,
        )

    def _halts(self, before: list[TreeStatus], after: list[TreeStatus]) -> tuple[Halt, ...]:
        """Return the nodes that ran, in this tick or the last, and were stopped since."""
        running, invalid = TreeStatus.RUNNING, TreeStatus.INVALID
        return tuple(
            Halt(node, self._halted_by(node, after))
            for node, status in enumerate(after)
            if status is invalid and self._answers.get(node, before[node]) is running
        )

    def _halted_by(self, node: int, after: list[TreeStatus]) -> int:
        parent = self._parents[node]
        while parent is not None and after[parent] is TreeStatus.INVALID:
            parent = self._parents[parent]
        return RUNNER if parent is None else parent

    def _outcome(self, node: int, behaviour: Behaviour) -> list[NodeOutcome]:
        """Return how a node ended, if it decided that itself."""
        outcome = getattr(behaviour, "outcome", None)
        reason = outcome.reason if isinstance(outcome, Outcome) else None
        if behaviour.children and reason is None and node not in self.reasons:
            return []
        if reason is None:
            self.reasons.pop(node, None)
        else:
            self.reasons[node] = reason
        return [NodeOutcome(node, _STATUS[behaviour.status], reason)]

    def _is_news(self, number: int, outcome: NodeOutcome) -> bool:
        """Return whether the node did not end the same way in the tick before.

        Conditions of a reactive branch answer the same in every tick; only their first
        answer is worth a record, the visits tell the rest.
        """
        said = (outcome.status, str(outcome.reason))
        last = self._told.get(outcome.node)
        self._told[outcome.node] = (number, *said)
        return last is None or last != (number - 1, *said)

    def error_of(self, behaviour: Behaviour, number: int, cause: Exception) -> NodeError:
        """Return what a node raised, with the path and type of the node and the tick."""
        if isinstance(cause, NodeError):
            return cause
        node = self._index.get(id(behaviour))
        if node is None:
            return NodeError(behaviour.name, type(behaviour).__name__, number, cause)
        return NodeError(self._tree.nodes[node].path, self._tree.nodes[node].type, number, cause)

    def _remember_raising(self, cause: BaseException) -> Behaviour:
        """Return the node that raised, and remember it if it still has to be stopped."""
        behaviour, terminating = _raising_node(cause, self._tree.root)
        if terminating:
            # It has had its one call; the status says that to whoever stops the rest.
            behaviour.status = TreeStatus.INVALID
        else:
            self.raised = behaviour
        return behaviour


def _raising_node(cause: BaseException, root: Behaviour) -> tuple[Behaviour, bool]:
    """Return the innermost node whose method raised, and whether it was in `terminate`.

    Composites call their children inside generators, so the exception itself does not say
    which node it came from (trap e1); the traceback does.
    """
    found, terminating = root, False
    for frame, _ in traceback.walk_tb(cause.__traceback__):
        caller = frame.f_locals.get("self")
        if isinstance(caller, Behaviour):
            terminating = frame.f_code.co_name == "terminate" or (terminating and caller is found)
            found = caller
    return found, terminating


def fault_of(error: Exception) -> NodeFault:
    """Return the record of an error; one of the cell or an observer has no path."""
    cause: BaseException = error
    path = node_type = ""
    if isinstance(error, NodeError):
        path, node_type, cause = error.path, error.node_type, error.__cause__ or error
    text = "".join(traceback.format_exception(cause))
    return NodeFault(path, node_type, f"{type(cause).__name__}: {cause}", text)
