"""An emergency stop acts at once, whoever asks for it and whatever a tick is doing."""

import signal
import threading

from toy_missions import Rehearsal
from toy_runs import RUNNING, Leaf, Ticks, ToyCell, built

from executive.core.errors import DeviceError
from executive.engine.running.control import RunControl, stopped_by_signals
from executive.engine.running.runner import MissionOutcome, Runner


class WatchedCell(ToyCell):
    """Notes which thread made the emergency stop."""

    def __init__(self, fails=0):
        super().__init__()
        self.threads, self.fails = [], fails

    def emergency_stop(self):
        super().emergency_stop()
        self.threads.append(threading.current_thread().name)
        if len(self.threads) <= self.fails:
            raise OSError("no answer")


def run(leaf, cell, control, seen=None):
    observers = (seen or Ticks(),)
    return Runner(built(leaf), cell, tick_hz=10.0, observers=observers, control=control).run()


def test_it_reaches_the_cell_while_a_tick_hangs():
    control, cell = RunControl(), WatchedCell()
    hanging, braked = threading.Event(), threading.Event()

    def hang():
        hanging.set()
        assert braked.wait(10.0)
        return RUNNING

    def light_curtain():
        hanging.wait(10.0)
        control.emergency_stop("light curtain")
        braked.set()  # only now may the tick end

    leaf = Leaf("work", hang)
    thread = threading.Thread(target=light_curtain, name="light curtain")
    thread.start()
    result = run(leaf, cell, control)
    thread.join()
    assert cell.threads == ["light curtain"]
    assert cell.calls == ["emergency_stop", "stop"]
    assert result.outcome is MissionOutcome.ABORTED
    assert result.reason == "emergency stop by light curtain in work"
    assert len(leaf.terminations) == 1


def test_what_a_node_raises_after_it_is_recorded_and_changes_nothing():
    control, seen = RunControl(), Ticks()

    def lose_the_arms():
        control.emergency_stop("light curtain")
        raise DeviceError("arms: an emergency stop was made")

    result = run(Leaf("work", lose_the_arms), WatchedCell(), control, seen)
    assert result.outcome is MissionOutcome.ABORTED
    assert "an emergency stop was made" in seen.ticks[0].faults[0].message


def test_it_is_tried_again_when_the_cell_does_not_answer():
    control, cell = RunControl(), WatchedCell(fails=1)
    raised = []

    def try_it():
        try:
            control.emergency_stop("light curtain")
        except OSError as error:
            raised.append(str(error))
        return RUNNING

    result = run(Leaf("work", try_it), cell, control)
    assert raised == ["no answer"]
    assert len(cell.threads) == 2
    assert result.outcome is MissionOutcome.ABORTED


def test_it_may_be_asked_for_before_the_run_begins():
    control, cell = RunControl(), WatchedCell()
    control.emergency_stop("light curtain")
    result = run(Leaf("work", RUNNING), cell, control)
    assert (result.ticks, result.outcome) == (0, MissionOutcome.ABORTED)
    assert cell.calls == ["emergency_stop", "stop"]


def test_it_ends_a_pause(tmp_path):
    control = RunControl()
    rehearsal = Rehearsal(tmp_path, "{skill: swing}", control=control)
    control.pause("the operator")
    threading.Timer(0.05, control.emergency_stop, ["light curtain"]).start()
    assert rehearsal.run().outcome is MissionOutcome.ABORTED


def test_a_second_signal_outside_of_a_tick_brakes_from_a_thread_of_its_own():
    control, cell = RunControl(), WatchedCell()

    class Slow(Ticks):
        def on_tick(self, tick):
            if tick.number == 0:
                signal.raise_signal(signal.SIGINT)
                signal.raise_signal(signal.SIGINT)

    with stopped_by_signals(control):
        result = run(Leaf("work", RUNNING), cell, control, Slow())
    assert len(cell.threads) == 1
    assert result.reason.startswith("emergency stop by SIGINT")


def test_a_pause_within_a_tick_leaves_the_rest_of_the_tick_interruptible():
    control, cell = RunControl(), WatchedCell()

    def hang():
        with control.interruptible():
            pass
        signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGINT)
        raise AssertionError("the second signal must not come back here")

    with stopped_by_signals(control):
        result = run(Leaf("work", hang), cell, control)
    assert result.reason.startswith("emergency stop by SIGINT")


def test_ctrl_z_pauses_and_lets_go_on(tmp_path):
    control = RunControl()
    rehearsal = Rehearsal(tmp_path, "{skill: swing, in: {steps: 3}}", control=control)
    note = rehearsal.journal.note

    def press(line):
        note(line)
        if line == "hold 1":
            signal.raise_signal(signal.SIGTSTP)
            threading.Timer(0.05, lambda: control.on_pause_signal(signal.SIGTSTP, None)).start()

    rehearsal.journal.note = press
    before = signal.getsignal(signal.SIGTSTP)
    with stopped_by_signals(control):
        assert rehearsal.run().outcome is MissionOutcome.SUCCESS
    assert signal.getsignal(signal.SIGTSTP) is before
    assert [(pause.state, pause.by) for pause in rehearsal.pauses] == [
        ("paused", "SIGTSTP"),
        ("resumed", "SIGTSTP"),
    ]
