"""The runner ends every mission with everything stopped, whatever happens (traps e1-e5)."""

import signal
import threading
import time

import pytest
from py_trees.common import ParallelPolicy, Status
from py_trees.composites import Parallel, Selector, Sequence
from py_trees.decorators import Inverter
from toy_runs import Leaf, Ticks, ToyCell, built

from executive.core.clock import ManualClock
from executive.core.errors import NodeError
from executive.core.outcome import failure
from executive.engine.nodes.decorators import Timeout
from executive.engine.running.control import RunControl, stopped_by_signals
from executive.engine.running.runner import MissionOutcome, Runner
from executive.engine.ticks import RUNNER, Halt, NodeStatus

RUNNING, SUCCESS, FAILURE, INVALID = (
    Status.RUNNING,
    Status.SUCCESS,
    Status.FAILURE,
    Status.INVALID,
)


def raises(error):
    """Return something to call that raises."""

    def act():
        raise error

    return act


def run(root, cell=None, **settings):
    """Run a hand-made tree on a toy cell; return its result, the ticks seen, and the cell."""
    cell, seen = cell or ToyCell(), Ticks()
    settings.setdefault("observers", (seen,))
    result = Runner(built(root), cell, tick_hz=10.0, **settings).run()
    return result, seen.ticks, cell


def together(*children):
    return Parallel("together", ParallelPolicy.SuccessOnAll(synchronise=False), children)


@pytest.mark.parametrize(
    ("answer", "outcome", "exit_code"),
    [(SUCCESS, MissionOutcome.SUCCESS, 0), (FAILURE, MissionOutcome.FAILURE, 1)],
)
def test_the_answer_of_the_root_is_the_outcome_of_the_mission(answer, outcome, exit_code):
    result, ticks, cell = run(Leaf("work", RUNNING, RUNNING, answer))
    assert (result.outcome, result.outcome.exit_code) == (outcome, exit_code)
    assert result.ticks == len(ticks) == 3
    assert result.sim_s == pytest.approx(0.2)
    assert cell.calls == ["stop"]


def test_failure_names_the_leaf_that_decided_and_its_reason():
    root = Sequence(
        "mission",
        memory=True,
        children=[
            Leaf("look", SUCCESS),
            Selector(
                "ways",
                memory=True,
                children=[
                    Leaf("left", failure("grasp.missed", "closed on nothing")),
                    Leaf("right", failure("motion.unreachable", "too far")),
                ],
            ),
        ],
    )
    result, _, _ = run(root)
    assert result.reason == "mission/ways/right: motion.unreachable: too far"
    assert [cause.path for cause in result.causes] == ["mission/ways/left", "mission/ways/right"]


def test_a_decorator_that_turns_the_answer_is_followed_to_its_child():
    result, _, _ = run(Inverter("not", Leaf("alarm", SUCCESS)))
    assert result.reason == "not/alarm: success"


def test_a_decorator_that_answers_by_itself_is_the_cause_and_is_recorded():
    cell = ToyCell()
    work = Leaf("work", RUNNING)
    result, ticks, _ = run(Timeout("limit", work, seconds=0.25, clock=cell.clock), cell)
    assert result.reason == "limit: timeout: not done after 0.25 s"
    assert [outcome.reason.code for outcome in ticks[-1].outcomes] == ["timeout"]
    assert ticks[-1].halts == (Halt(1, 0),)
    assert work.terminations == [INVALID]


def test_e1_an_exception_stops_every_running_leaf_once_and_names_its_node():
    steady, bad, late = (
        Leaf("steady", RUNNING),
        Leaf("bad", RUNNING, raises(ValueError("broken wire"))),
        Leaf("late", RUNNING),
    )
    result, ticks, cell = run(together(steady, bad, late))
    assert result.outcome is MissionOutcome.ERROR
    assert [leaf.terminations for leaf in (steady, bad, late)] == [[INVALID]] * 3
    (error,) = result.errors
    assert isinstance(error, NodeError)
    assert (error.path, error.tick) == ("together/bad", 1)
    assert isinstance(error.__cause__, ValueError)
    assert result.reason == "together/bad (Leaf): raised at tick 1: ValueError: broken wire"
    assert cell.calls == ["stop"]
    (fault,) = ticks[1].faults
    assert fault.path == "together/bad"
    assert "broken wire" in fault.traceback


def test_e1_a_leaf_that_raises_in_its_first_update_is_stopped_too():
    bad = Leaf("bad", raises(ValueError("at once")))
    run(bad)
    assert (bad.starts, bad.terminations) == (1, [INVALID])


def test_e1_an_exception_of_a_composite_names_the_composite():
    class Faulty(Sequence):
        def tick(self):
            raise KeyError("list")
            yield self

    result, _, _ = run(Sequence("mission", memory=True, children=[Faulty("inner", memory=True)]))
    assert result.errors[0].path == "mission/inner"


def test_e2_an_exception_in_terminate_keeps_no_sibling_from_being_stopped():
    first = Leaf("first", RUNNING, on_terminate=raises(OSError("valve")))
    second = Leaf("second", RUNNING)
    result, ticks, cell = run(together(first, second), timeout_s=0.25)
    assert first.terminations == second.terminations == [INVALID]
    assert result.outcome is MissionOutcome.ERROR
    assert "together/first" in result.reason
    assert cell.calls == ["stop"]
    assert ticks[-1].faults[0].message == "OSError: valve"


def test_e2_a_terminate_that_raises_within_a_tick_is_called_once():
    guard = Leaf("guard", SUCCESS, FAILURE)
    moving = Leaf("moving", RUNNING, on_terminate=raises(OSError("valve")))
    beside = Leaf("beside", RUNNING)
    reactive = Sequence("reactive", memory=False, children=[guard, moving])
    result, _, _ = run(together(beside, reactive))
    assert result.outcome is MissionOutcome.ERROR
    assert moving.terminations == beside.terminations == [INVALID]
    assert result.errors[0].path == "together/reactive/moving"


def test_e3_the_deadline_ends_the_mission_with_its_leaves_stopped():
    leaf = Leaf("work", RUNNING)
    result, ticks, cell = run(leaf, timeout_s=0.45)
    assert (result.outcome, result.outcome.exit_code) == (MissionOutcome.TIMEOUT, 1)
    assert result.reason == "mission timeout of 0.45 s passed in work"
    assert leaf.terminations == [INVALID]
    assert result.ticks == 5
    assert ticks[-1].visited == ()
    assert ticks[-1].halts == (Halt(0, RUNNER),)
    assert cell.calls == ["stop"]


def test_e3_late_ticks_are_counted_and_do_not_move_the_grid():
    cell = ToyCell()

    def take_long():
        cell.clock.sleep_until(cell.clock.now_s() + 0.25)
        return RUNNING

    result, ticks, _ = run(Leaf("slow", take_long, RUNNING, RUNNING, SUCCESS), cell)
    assert [tick.time_s for tick in ticks] == pytest.approx([0.0, 0.3, 0.4, 0.5])
    assert result.rate.overruns == 1
    assert result.rate.achieved_hz == pytest.approx(6.0)


def test_e4_setup_reports_every_failure_and_works_outside_the_main_thread():
    class NeedsSetup(Leaf):
        def setup(self):
            raise OSError(f"no {self.name}")

    root = Sequence(
        "mission", memory=True, children=[NeedsSetup("camera", SUCCESS), NeedsSetup("arm", SUCCESS)]
    )
    results = []
    thread = threading.Thread(target=lambda: results.append(run(root)))
    thread.start()
    thread.join()
    result, ticks, _ = results[0]
    assert result.outcome is MissionOutcome.ERROR
    assert [error.path for error in result.errors] == ["mission/camera", "mission/arm"]
    assert [fault.message for fault in ticks[0].faults] == ["OSError: no camera", "OSError: no arm"]
    assert result.ticks == 0


def test_e5_shutdown_reaches_every_node_and_reports_all_that_raised():
    class Sticky(Leaf):
        shut = False

        def shutdown(self):
            self.shut = True
            raise OSError(self.name)

    leaves = [Sticky("a", SUCCESS), Sticky("b", SUCCESS)]
    result, _, cell = run(Sequence("mission", memory=True, children=leaves))
    assert all(leaf.shut for leaf in leaves)
    assert [error.path for error in result.errors] == ["mission/a", "mission/b"]
    assert result.outcome is MissionOutcome.ERROR
    assert cell.calls == ["stop"]


def test_e13_an_update_without_a_status_is_an_error_of_its_node():
    result, _, _ = run(Sequence("mission", memory=True, children=[Leaf("forgot", lambda: None)]))
    assert result.outcome is MissionOutcome.ERROR
    assert "mission/forgot" in result.reason
    assert "expected Status.RUNNING" in result.reason


def test_e16_a_node_that_another_one_halts_is_recorded_with_who_did_it():
    watch = Leaf("watch", FAILURE, FAILURE, SUCCESS)
    work = Leaf("work", RUNNING)
    root = Selector("mission", memory=False, children=[watch, work])
    _, ticks, _ = run(root)
    assert ticks[2].visited == (1, 0)
    assert ticks[2].halts == (Halt(2, 0),)
    assert (2, NodeStatus.INVALID) in ticks[2].changes


def test_a_repeated_answer_of_a_condition_is_recorded_once():
    root = Sequence(
        "mission",
        memory=False,
        children=[Leaf("safe", SUCCESS), Leaf("work", *[RUNNING] * 3, SUCCESS)],
    )
    _, ticks, _ = run(root)
    assert [[end.node for end in tick.outcomes] for tick in ticks] == [[1], [], [], [2]]


def test_an_observer_that_raises_ends_the_run_with_the_arms_stopped():
    class Full(Ticks):
        def on_tick(self, tick):
            raise OSError("disk full")

    leaf = Leaf("work", RUNNING)
    result, _, cell = run(leaf, observers=(Full(),))
    assert result.outcome is MissionOutcome.ERROR
    assert "disk full" in result.reason
    assert leaf.terminations == [INVALID]
    assert cell.calls == ["stop"]


def test_a_cell_that_breaks_between_ticks_ends_the_run_and_is_recorded():
    class BrokenClock(ManualClock):
        def sleep_until(self, time_s):
            raise OSError("no answer")

    leaf = Leaf("work", RUNNING)
    result, ticks, cell = run(leaf, ToyCell(clock=BrokenClock()))
    assert result.outcome is MissionOutcome.ERROR
    assert result.reason == "OSError: no answer"
    assert [(fault.path, fault.message) for fault in ticks[-1].faults] == [
        ("", "OSError: no answer")
    ]
    assert leaf.terminations == [INVALID]
    assert cell.calls == ["stop"]


def test_a_cell_that_cannot_be_stopped_is_an_error_even_after_a_success():
    result, _, _ = run(Leaf("work", SUCCESS), ToyCell(on_stop=raises(OSError("no answer"))))
    assert result.outcome is MissionOutcome.ERROR
    assert "no answer" in result.reason


def test_stop_from_another_thread_ends_in_order():
    control = RunControl()
    leaf = Leaf("work", lambda: time.sleep(0.001) or RUNNING)
    threading.Timer(0.05, control.stop, ["the operator"]).start()
    result, _, cell = run(leaf, control=control)
    assert (result.outcome, result.outcome.exit_code) == (MissionOutcome.ABORTED, 4)
    assert result.reason == "stopped by the operator in work"
    assert leaf.terminations == [INVALID]
    assert cell.calls == ["stop"]


def test_emergency_stop_reaches_the_cell_before_the_leaves():
    control, cell = RunControl(), ToyCell()
    leaf = Leaf("work", RUNNING, on_terminate=lambda: cell.calls.append("leaf"))
    leaf.answers = [RUNNING, lambda: control.emergency_stop("light curtain") or RUNNING]
    result, _, _ = run(leaf, cell, control=control)
    assert cell.calls == ["emergency_stop", "leaf", "stop"]
    assert result.reason == "emergency stop by light curtain in work"


def test_pause_holds_ticks_and_does_not_eat_the_deadline():
    control, cell = RunControl(), ToyCell()
    leaf = Leaf("work", RUNNING, lambda: control.pause() or RUNNING, RUNNING, RUNNING, SUCCESS)

    def resume_later():
        cell.clock.sleep_until(cell.clock.now_s() + 60.0)
        control.resume()

    threading.Timer(0.1, resume_later).start()
    result, ticks, _ = run(leaf, cell, control=control, timeout_s=5.0)
    assert result.outcome is MissionOutcome.SUCCESS
    assert ticks[-1].time_s > 60.0
    assert result.rate.achieved_hz == pytest.approx(10.0)
    assert result.rate.overruns == 0


def test_one_signal_stops_in_order_and_two_break_into_a_tick():
    control = RunControl()

    def hang():
        signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGINT)
        raise AssertionError("the second signal must not come back here")

    before = signal.getsignal(signal.SIGINT)
    leaf, cell = Leaf("work", RUNNING, hang), ToyCell()
    with stopped_by_signals(control):
        result, _, _ = run(leaf, cell, control=control)
    assert signal.getsignal(signal.SIGINT) is before
    assert result.outcome is MissionOutcome.ABORTED
    assert result.reason.startswith("emergency stop by SIGINT")
    assert leaf.terminations == [INVALID]
    assert cell.calls[0] == "emergency_stop"


def test_a_skill_cannot_swallow_an_emergency_stop():
    control = RunControl()

    def stubborn():
        try:
            signal.raise_signal(signal.SIGINT)
            signal.raise_signal(signal.SIGINT)
        except Exception:
            return RUNNING
        return RUNNING

    with stopped_by_signals(control):
        result, _, _ = run(Leaf("work", stubborn), control=control)
    assert result.outcome is MissionOutcome.ABORTED
