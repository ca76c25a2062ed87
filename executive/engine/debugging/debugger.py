"""Pauses a mission where a breakpoint or a step says so, and answers in the place of nodes.

The debugger works inside the process that ticks. Whoever commands it (a terminal, the page, a
breakpoint file) does so from any thread; the thread that ticks waits where it stands, between
two ticks or in the middle of one, and running skills follow their pause policies meanwhile.
"""

import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Any

import numpy as np
from py_trees.common import Status

from executive.core.errors import InputError
from executive.core.outcome import RUNNING, Outcome, failure, success
from executive.core.outcome import Status as Answer
from executive.core.registry import closest
from executive.core.world import StreamMessage
from executive.engine.debugging.breakpoints import Breakpoint, Event, parse_breakpoint
from executive.engine.debugging.names import BoardNames
from executive.engine.debugging.stepping import Step, Stride, stride
from executive.engine.language.expression import Expression
from executive.engine.language.node_patterns import matching
from executive.engine.nodes.builder import BuiltTree
from executive.engine.nodes.calls import TickCall
from executive.engine.nodes.interception import Junction
from executive.engine.running.control import EmergencyStopped, RunControl
from executive.engine.running.interventions import InterventionLog
from executive.engine.ticks import Tick

FORCED = "debug.forced"
"""Reason code of a failure that a debugger has forced."""

_ANSWERS: Mapping[str, Outcome] = {
    "success": success(),
    "failure": failure(FORCED, "forced while debugging"),
    "running": RUNNING,
}
_ENDS: Mapping[Event, tuple[Status, ...]] = {
    Event.SUCCESS: (Status.SUCCESS,),
    Event.FAILURE: (Status.FAILURE,),
    Event.END: (Status.SUCCESS, Status.FAILURE),
}
_IN_TICKS = (Event.START, *_ENDS)


@dataclass(frozen=True, slots=True)
class Standing:
    """Where a mission stands while it is paused by the debugger.

    Attributes:
        why: The breakpoint, or the step.
        tick: Number of the tick.
        node: Path of the node in the middle of a tick; empty between two.
        answered: Whether that node has just answered, rather than being about to be ticked.
    """

    why: str
    tick: int
    node: str = ""
    answered: bool = False


@dataclass(slots=True)
class _Armed:
    """A breakpoint with the nodes that it means."""

    number: int
    breakpoint: Breakpoint
    nodes: frozenset[int]
    hits: int = 0

    @property
    def watches(self) -> bool:
        """Whether it can only be seen in the middle of a tick."""
        return self.breakpoint.event in _IN_TICKS


class Debugger:
    """Breakpoints, steps and forced answers of one run."""

    def __init__(self, tree: BuiltTree, control: RunControl) -> None:
        """Watch a tree; `control` is that of its run."""
        self._tree, self._control = tree, control
        self.interventions = InterventionLog()
        self._leaves = frozenset(node.index for node in tree.nodes if not node.behaviour.children)
        self._lock = threading.RLock()
        self._armed: list[_Armed] = []
        self._count = 0
        self._forced: dict[int, tuple[Outcome, bool]] = {}
        self._stride: Stride | None = None
        self._standing: Standing | None = None
        self._at: int | None = None
        self._tick = 0
        self._wait: Callable[[], None] = lambda: None

    def waits_with(self, wait: Callable[[], None]) -> None:
        """Say how the ticking thread waits while the run is paused; the runner does so."""
        self._wait = wait

    @property
    def standing(self) -> Standing | None:
        """Where the mission stands, None while it goes on."""
        if not self._control.paused:
            return None
        return self._standing or Standing("paused", self._tick)

    @property
    def watches_nodes(self) -> bool:
        """Whether it has to stand between nodes and their parents now."""
        with self._lock:
            walks = self._stride is not None and self._stride.step is not Step.TICK
            return walks or bool(self._forced) or any(one.watches for one in self._armed)

    def add(self, text: str) -> int:
        """Set a breakpoint and return its number.

        Raises:
            InputError: It is none, or means no node of this tree.
        """
        wanted = parse_breakpoint(text)
        nodes = matching(self._tree.nodes, wanted.node) if wanted.node else self._leaves
        with self._lock:
            self._count += 1
            self._armed = [*self._armed, _Armed(self._count, wanted, nodes)]
            return self._count

    def remove(self, number: int) -> None:
        """Take a breakpoint away.

        Raises:
            InputError: There is none of that number.
        """
        with self._lock:
            left = [one for one in self._armed if one.number != number]
            if len(left) == len(self._armed):
                known = [str(one.number) for one in self._armed]
                raise InputError(f"no breakpoint {number}; {closest(str(number), known)}")
            self._armed = left

    def breakpoints(self) -> list[dict[str, object]]:
        """Return number, text and hits of every breakpoint."""
        return [
            {"number": one.number, "text": one.breakpoint.text, "hits": one.hits}
            for one in self._armed
        ]

    def force(self, pattern: str, answer: str, *, once: bool, by: str) -> list[str]:
        """Make nodes answer so without being ticked, once or until `unforce`.

        Returns:
            Their paths.

        Raises:
            InputError: The pattern means no node, or the answer is none.
        """
        if answer not in _ANSWERS:
            raise InputError(f"answer: got {answer!r}; {closest(answer, [*_ANSWERS])}")
        nodes = sorted(matching(self._tree.nodes, pattern))
        with self._lock:
            for node in nodes:
                self._forced[node] = _ANSWERS[answer], once
                self._note(node, f"force {answer}{' once' if once else ''}", by)
        return [self._tree.nodes[node].path for node in nodes]

    def unforce(self, pattern: str, *, by: str) -> list[str]:
        """Let nodes answer for themselves again; return their paths."""
        nodes = sorted(matching(self._tree.nodes, pattern) & self._forced.keys())
        with self._lock:
            for node in nodes:
                del self._forced[node]
                self._note(node, "unforce", by)
        return [self._tree.nodes[node].path for node in nodes]

    def forced(self) -> dict[str, str]:
        """Return the answers that are forced, by path."""
        return {
            self._tree.nodes[node].path: outcome.status.value.lower()
            for node, (outcome, _) in sorted(self._forced.items())
        }

    def step(self, step: Step, by: str) -> None:
        """Go on from a pause, and stop again after a step."""
        with self._lock:
            self._stride, self._standing = stride(step, self._tree.nodes, self._at), None
        self._control.resume(by)

    def go_on(self, by: str) -> None:
        """Go on from a pause."""
        with self._lock:
            self._stride, self._standing = None, None
        self._control.resume(by)

    def intercept(self, junction: Junction) -> TickCall:
        """Return the call that a parent makes instead of ticking a node; an `Interceptor`."""
        index, node, tick = junction.index, junction.node, junction.tick

        def debugged() -> Status:
            starts = node.status is not Status.RUNNING
            self._before(index, starts=starts)
            outcome = self._answer_for(index)
            status = tick() if outcome is None else junction.answer(outcome)
            if status is not Status.RUNNING:
                self._after(index, status)
            return status

        return debugged

    def before_tick(self, number: int) -> None:
        """Pause before a tick that a breakpoint names."""
        self._tick, self._at = number, None
        for one in self._armed:
            if one.breakpoint.event is Event.TICK and one.breakpoint.number == number:
                self._hit(one, None)

    def on_tick(self, tick: Tick) -> None:
        """Pause after a tick in which something happened that a breakpoint waits for."""
        for one in self._armed:
            node = self._happened(one, tick)
            if node is not None and self._holds(one.breakpoint.condition, node):
                self._hit(one, None)
        if self._stride is not None and self._stride.step is Step.TICK:
            self._pause(Standing("step", tick.number))

    def on_streams(self, messages: Sequence[StreamMessage]) -> None:
        """Take what the cell streamed; nothing to do."""

    def _before(self, index: int, *, starts: bool) -> None:
        if self._stride is not None and self._stride.ends_before(index):
            self._stop_at(Standing("step", self._tick, self._tree.nodes[index].path), index)
        if not starts:
            return
        for one in self._armed:
            if one.breakpoint.event is Event.START and index in one.nodes:
                self._hit_if_true(one, index)

    def _after(self, index: int, status: Status) -> None:
        for one in self._armed:
            if status in _ENDS.get(one.breakpoint.event, ()) and index in one.nodes:
                self._hit_if_true(one, index, answered=True)

    def _happened(self, one: _Armed, tick: Tick) -> int | None:
        """Return the node that an event of a tick is about, the root where it is about none."""
        wanted = one.breakpoint
        if wanted.event is Event.HALT:
            return next((halt.node for halt in tick.halts if halt.node in one.nodes), None)
        happened = (
            (wanted.event is Event.FAULT and bool(tick.faults))
            or (wanted.event is Event.SLOW and tick.duration_s > wanted.number)
            or (wanted.event is Event.WRITE and self._wrote(wanted.key, tick))
        )
        return 0 if happened else None

    def _wrote(self, pattern: str, tick: Tick) -> bool:
        return any(
            fnmatchcase(write.key, pattern) or fnmatchcase(write.key, f"*:{pattern}")
            for write in tick.writes
        )

    def _holds(self, condition: Expression | None, node: int) -> bool:
        """Return whether a condition is true; one that cannot be asked yet is not."""
        if condition is None:
            return True
        names: Any = BoardNames(self._tree.blackboard, self._tree.nodes[node].path)
        try:
            value = condition.evaluate(names)
        except InputError:
            return False
        return isinstance(value, bool | np.bool_) and bool(value)

    def _hit_if_true(self, one: _Armed, node: int, *, answered: bool = False) -> None:
        if self._holds(one.breakpoint.condition, node):
            self._hit(one, node, answered=answered)

    def _hit(self, one: _Armed, node: int | None, *, answered: bool = False) -> None:
        one.hits += 1
        why = f"breakpoint {one.number}: {one.breakpoint.text}"
        path = "" if node is None else self._tree.nodes[node].path
        standing = Standing(why, self._tick, path, answered)
        if node is None:
            self._pause(standing)
        else:
            self._stop_at(standing, node)

    def _pause(self, standing: Standing) -> None:
        with self._lock:
            self._stride, self._standing = None, standing
        self._control.pause(standing.why)

    def _stop_at(self, standing: Standing, node: int) -> None:
        """Wait in the middle of a tick.

        Raises:
            EmergencyStopped: The mission is to end; no further node of this tick is ticked.
        """
        self._at = node
        self._pause(standing)
        self._wait()
        if self._control.stop_reason:
            raise EmergencyStopped

    def _answer_for(self, index: int) -> Outcome | None:
        forced = self._forced.get(index)
        if forced is None:
            return None
        outcome, once = forced
        if once:
            with self._lock:
                self._forced.pop(index, None)
        self._note(index, "answered", "the debugger", outcome.status)
        return outcome

    def _note(self, node: int, what: str, by: str, answer: Answer | None = None) -> None:
        self.interventions.note(self._tick, node, what, by, answer)
