"""Runs a tree on a cell: tick by tick until it has an answer, a deadline or a request to stop.

However a run ends, every running node is stopped once, the cell is brought to rest, and all
of it is told to the observers; the recorder is one of them.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property

from py_trees.behaviour import Behaviour

from executive.core.errors import DeviceError, NodeError
from executive.core.world import Cell, StreamMessage
from executive.engine.checkpoints.messages import Progress
from executive.engine.checkpoints.past import Moment, Past
from executive.engine.debugging.debugger import Debugger
from executive.engine.nodes.builder import BuiltTree, NodeInfo
from executive.engine.nodes.interception import Interceptor, chained
from executive.engine.running.causes import Cause, deciding_leaves
from executive.engine.running.control import EmergencyStopped, RunControl
from executive.engine.running.interventions import InterventionLog
from executive.engine.running.pausing import Pauses
from executive.engine.running.probe import TreeProbe, fault_of
from executive.engine.running.rate import Rate, RateReport
from executive.engine.running.stopping import each_guarded, stop_running
from executive.engine.ticks import NodeStatus, RunObserver, SlowStep, Tick


class MissionOutcome(StrEnum):
    """How a mission ended."""

    SUCCESS = "success"
    FAILURE = "failure"
    TIMEOUT = "timeout"
    ABORTED = "aborted"
    ERROR = "error"

    @property
    def exit_code(self) -> int:
        """Exit code of the command line."""
        return _EXIT_CODES[self]


_EXIT_CODES = {
    MissionOutcome.SUCCESS: 0,
    MissionOutcome.FAILURE: 1,
    MissionOutcome.TIMEOUT: 1,
    MissionOutcome.ERROR: 3,
    MissionOutcome.ABORTED: 4,
}


@dataclass(frozen=True, slots=True)
class RunResult:
    """What a run came to.

    Attributes:
        outcome: How it ended.
        reason: Why, in one line; empty after a success.
        causes: Leaves that decided the tree's answer; empty unless the tree gave one.
        ticks: Number of ticks.
        sim_s: Duration on the cell's clock [s].
        wall_s: Duration on the machine's clock [s].
        rate: How well the tick rate was kept.
        errors: What was raised, the first one first.
        survived: What leaves raised without ending the mission, in order.
    """

    outcome: MissionOutcome
    reason: str
    causes: tuple[Cause, ...]
    ticks: int
    sim_s: float
    wall_s: float
    rate: RateReport
    errors: tuple[Exception, ...]
    survived: tuple[NodeError, ...] = ()


@dataclass(frozen=True, slots=True)
class _Ending:
    """Why the tick loop was left."""

    outcome: MissionOutcome
    reason: str = ""
    causes: tuple[Cause, ...] = ()
    errors: tuple[Exception, ...] = ()


class Runner:
    """One run of one tree; use it once."""

    def __init__(
        self,
        tree: BuiltTree,
        cell: Cell,
        *,
        tick_hz: float,
        timeout_s: float | None = None,
        observers: Sequence[RunObserver] = (),
        control: RunControl | None = None,
        debugger: Debugger | None = None,
        interceptors: Sequence[Interceptor] = (),
        interventions: Sequence[InterventionLog] = (),
        past: Past | None = None,
    ) -> None:
        """Prepare a run; nothing moves yet.

        Args:
            tree: The tree; it has not been ticked.
            cell: Where it runs.
            tick_hz: Ticks a second of the cell's clock.
            timeout_s: Longest duration on the cell's clock [s], pauses not counted.
            observers: Told of every tick; one that raises ends the run.
            control: How to pause and stop it.
            debugger: Who may pause it anywhere and answer for nodes; made with that control.
            interceptors: What stands between nodes and their parents besides.
            interventions: What these have done, for the recording.
            past: What was before, when it goes on from a checkpoint.
        """
        self._tree, self._cell, self._clock = tree, cell, cell.clock
        self._timeout_s = timeout_s
        self._observers = tuple(observers)
        self.control = control or RunControl()
        self._debugger = debugger
        if debugger is not None:
            debugger.waits_with(self._wait_in_tick)
            self._observers = (*self._observers, debugger)
        self._interceptors = tuple(interceptors)
        own = () if debugger is None else (debugger.interventions,)
        self._interventions = (*own, *interventions)
        self._probe = TreeProbe(tree, chained(self._interceptors))
        self._watched = False
        now_s = self._clock.now_s()
        begun = Progress(tick=0, time_s=now_s, start_s=now_s, grid_s=now_s)
        if past is not None:
            begun = past.progress
            self._probe.go_on(past)
        self._start_s, self._number = begun.start_s, begun.tick
        self._rate = Rate(tick_hz, begun.grid_s, now_s=now_s, paused_s=begun.paused_s)
        self._pauses = Pauses(
            tree,
            self._clock,
            self.control,
            period_s=1.0 / tick_hz,
            tell=self._tell_streams,
            error_of=self._error_of,
        )
        self._told: NodeError | None = None
        self._survived: list[NodeError] = []

    @property
    def moment(self) -> Moment:
        """How far the run has come, in the middle of a tick too."""
        events, outcomes = self._probe.so_far()
        progress = Progress(
            tick=self._number,
            time_s=self._clock.now_s(),
            start_s=self._start_s,
            grid_s=self._rate.origin_s,
            paused_s=self._rate.paused_s,
        )
        return Moment(progress, events, outcomes)

    def run(self) -> RunResult:
        """Tick until the mission ends, whatever ends it; then stop everything.

        Returns:
            How it ended. Nothing that a node, the cell or an observer raises gets out.
        """
        wall_start_s = time.perf_counter()
        self.control.brakes_with(self._cell.emergency_stop)
        ending = self._ending()
        ended_s = self._clock.now_s()
        errors = self._stop_everything(ending.errors)
        if errors and not ending.errors and ending.outcome is not MissionOutcome.ABORTED:
            ending = replace(ending, outcome=MissionOutcome.ERROR, reason=one_line(errors[0]))
        return RunResult(
            outcome=ending.outcome,
            reason=ending.reason,
            causes=ending.causes,
            ticks=self._number,
            sim_s=ended_s - self._start_s,
            wall_s=time.perf_counter() - wall_start_s,
            rate=self._rate.report(),
            errors=errors,
            survived=tuple(self._survived),
        )

    def _ending(self) -> _Ending:
        try:
            errors = self._each_node(lambda node: node.setup())
            return _broken(*errors) if errors else self._tick_until_the_end()
        except (EmergencyStopped, KeyboardInterrupt):
            return self._stopped_by_the_user()
        except BaseException as cause:  # also an exit: whatever it is, arms must still stop
            return _broken(self._located(cause))

    def _located(self, cause: BaseException) -> Exception:
        """Return an exception as it is, and an exit as an error of the node that asked for it."""
        if isinstance(cause, Exception):
            return cause
        return self._error_of(self._probe.raised or self._tree.root, cause)

    def _tick_until_the_end(self) -> _Ending:
        while True:
            if self._debugger is not None:
                self._debugger.before_tick(self._number)
            ending = self._paused() or self._interrupted() or self._tick()
            if ending is not None:
                return ending
            with self.control.interruptible():
                self._clock.sleep_until(self._rate.next_due_s(self._clock.now_s()))
            self._tell_streams()

    def _paused(self) -> _Ending | None:
        paused_s, errors = self._pauses.wait()
        self._rate.skip(paused_s)
        return _broken(*errors) if errors else None

    def _wait_in_tick(self) -> None:
        """Wait in the middle of a tick for as long as the run is paused."""
        paused_s, errors = self._pauses.wait()
        self._rate.skip(paused_s)
        if errors:
            raise errors[0]

    def _watch(self) -> None:
        """Put the debugger between nodes and parents, or take it away, as it needs to be."""
        debugger = self._debugger
        if debugger is not None and debugger.watches_nodes is not self._watched:
            self._watched = not self._watched
            first = (debugger.intercept,) if self._watched else ()
            self._probe.intercept_with(chained((*first, *self._interceptors)))

    def _tick(self) -> _Ending | None:
        self._watch()
        now_s = self._clock.now_s()
        self._tree.clock.hold(now_s)
        with self.control.interruptible():
            tick, error = self._probe.tick(self._number, now_s)
        tick = self._with_notes(tick)
        self._number += 1
        self._rate.ticked(now_s, tick.duration_s)
        for observer in self._observers:
            observer.on_tick(tick)
        self._told = error
        if self.control.emergency:
            # What a node raised when its arms were taken from it is no error of the mission.
            return self._stopped_by_the_user()
        return _broken(error) if error is not None else self._answer()

    def _with_notes(self, tick: Tick) -> Tick:
        """Add what leaves have noted about themselves."""
        late, raised = self._tree.supervision.drain()
        if not late and not raised:
            return tick
        errors = [self._error_of(self._places[one.path].behaviour, one.cause) for one in raised]
        self._survived += errors
        return replace(
            tick,
            slow=tuple(
                SlowStep(self._places[one.path].index, one.seconds, one.budget_s) for one in late
            ),
            faults=(*(fault_of(error) for error in errors), *tick.faults),
        )

    @cached_property
    def _places(self) -> Mapping[str, NodeInfo]:
        return {node.path: node for node in self._tree.nodes}

    def _answer(self) -> _Ending | None:
        answer = self._probe.answer
        if answer is NodeStatus.RUNNING:
            return None
        causes = deciding_leaves(self._tree.nodes, self._probe.answers, self._probe.reasons)
        if answer is NodeStatus.SUCCESS:
            return _Ending(MissionOutcome.SUCCESS, causes=causes)
        return _Ending(MissionOutcome.FAILURE, str(causes[-1]), causes)

    def _interrupted(self) -> _Ending | None:
        if self.control.stop_reason:
            return self._stopped_by_the_user()
        if self._timeout_s is None or self._running_s() < self._timeout_s:
            return None
        reason = f"mission timeout of {self._timeout_s:g} s passed {self._where()}"
        return _Ending(MissionOutcome.TIMEOUT, reason)

    def _running_s(self) -> float:
        return self._clock.now_s() - self._start_s - self._rate.paused_s

    def _stopped_by_the_user(self) -> _Ending:
        how = "emergency stop" if self.control.emergency else "stopped"
        who = self.control.stop_reason or "KeyboardInterrupt"
        return _Ending(MissionOutcome.ABORTED, f"{how} by {who} {self._where()}")

    def _where(self) -> str:
        """Return which leaves run now, for a message."""
        running = [
            info.path
            for info in self._tree.nodes
            if info.behaviour.status.name == NodeStatus.RUNNING and not info.behaviour.children
        ]
        if running:
            return f"in {', '.join(running)}"
        return "while no leaf was running" if self._number else "before the first tick"

    def _stop_everything(self, raised: tuple[Exception, ...]) -> tuple[Exception, ...]:
        """Stop nodes and cell, and tell the observers; return all that was raised in the run."""
        errors = list(raised)
        if self.control.emergency:
            errors += _raised_by(self.control.brake)
        errors += stop_running(self._tree.root, self._probe.raised, self._error_of)
        errors += _raised_by(self._stop_cell)
        errors += self._each_node(lambda node: node.shutdown())
        errors += _raised_by(lambda: self._tell_end(errors))
        return tuple(errors)

    def _stop_cell(self) -> None:
        try:
            with self.control.interruptible():
                self._cell.stop()
        except EmergencyStopped:
            self.control.brake()

    def _tell_end(self, errors: Sequence[Exception]) -> None:
        untold = [error for error in errors if error is not self._told]
        end = self._probe.record_end(self._number, self._clock.now_s(), untold)
        if end.changes or end.writes or end.faults:
            for observer in self._observers:
                observer.on_tick(end)
        self._tell_streams()

    def _tell_streams(self, more: Sequence[StreamMessage] = ()) -> None:
        for log in self._interventions:
            more = (*more, *log.drain(self._clock.now_s()))
        messages = (*self._cell.drain_streams(), *more)
        for observer in self._observers:
            observer.on_streams(messages)

    def _each_node(self, act: Callable[[Behaviour], None]) -> list[NodeError]:
        return each_guarded(self._tree.root.iterate(), act, self._error_of)

    def _error_of(self, behaviour: Behaviour, cause: BaseException) -> NodeError:
        return self._probe.error_of(behaviour, self._number, cause)


def one_line(error: Exception) -> str:
    """Return the message of an exception, with its type unless it is one of ours."""
    text = str(error) if isinstance(error, NodeError) else f"{type(error).__name__}: {error}"
    return " ".join(text.split())


def _broken(*errors: Exception) -> _Ending:
    return _Ending(
        MissionOutcome.ERROR, "; ".join(one_line(error) for error in errors), errors=errors
    )


def _raised_by(act: Callable[[], None]) -> list[Exception]:
    try:
        act()
    except Exception as cause:  # what follows must still be done
        return [cause]
    except BaseException as cause:  # also after an exit or an interrupt
        return [DeviceError(f"{type(cause).__name__} while the run was being ended: {cause}")]
    return []
