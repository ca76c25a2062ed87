"""A pause: held, finished, stopped; recorded; and no time of the mission."""

import threading

import pytest
from toy_missions import AtTick, Rehearsal

from executive.core.clock import ManualClock, MissionClock
from executive.core.skill import PausePolicy
from executive.engine.running.control import RunControl
from executive.engine.running.runner import MissionOutcome
from executive.engine.ticks import NodeStatus


class Waiting(RunControl):
    """A control whose pause ends once there is nothing left to wait for."""

    def __init__(self, then=None):
        super().__init__()
        self._then = then or (lambda: self.resume("the operator"))

    def wait(self, timeout_s):
        self._then()


def paused_at(folder, tick, root, keys="", control=None):
    control = control or Waiting()
    rehearsal = Rehearsal(folder, root, keys, control=control, observers=())
    pause = AtTick({tick: lambda: control.pause("the door")})
    rehearsal.runner._observers = (rehearsal.seen, pause)
    return rehearsal


def test_a_skill_that_holds_is_not_stepped_until_it_has_been_told_to_go_on(tmp_path):
    rehearsal = paused_at(tmp_path, 1, "{skill: swing, in: {steps: 4}}")
    assert rehearsal.run().outcome is MissionOutcome.SUCCESS
    assert rehearsal.journal.lines == [
        *("hold 0", "hold 1", "hold pauses", "hold resumes", "hold 2", "hold 3")
    ]


def test_a_skill_that_finishes_goes_on_alone_and_the_tree_takes_its_answer_later(tmp_path):
    rehearsal = paused_at(tmp_path, 1, "{skill: finish, in: {steps: 4}, out: {steps: $steps}}")
    result = rehearsal.run()
    assert rehearsal.journal.lines == ["finish 0", "finish 1", "finish 2", "finish 3"]
    assert result.outcome is MissionOutcome.SUCCESS
    *before, last = rehearsal.seen.ticks[:3]
    assert [tick.outcomes for tick in before] == [(), ()]
    assert last.time_s == pytest.approx(0.5)  # three steps of the pause came before it
    assert [write.key for write in last.writes] == ["m:steps"]


@pytest.mark.parametrize("ending", ["failure", "raise"])
def test_what_a_finishing_skill_comes_to_is_told_by_the_tree(tmp_path, ending):
    root = f"{{skill: finish, in: {{steps: 3, ending: {ending}}}}}"
    result = paused_at(tmp_path, 0, root).run()
    assert result.outcome.value == {"failure": "failure", "raise": "error"}[ending]
    assert {"failure": "swing.failed", "raise": "rope broke"}[ending] in result.reason


def test_a_skill_that_is_stopped_begins_anew_with_its_inputs(tmp_path):
    rehearsal = paused_at(tmp_path, 1, "{skill: restart, in: {steps: 3}}")
    assert rehearsal.run().outcome is MissionOutcome.SUCCESS
    assert rehearsal.journal.lines == [
        *("stop 0", "stop 1", "stop stops", "stop 0", "stop 1", "stop 2")
    ]


def test_a_pause_goes_to_every_leaf_that_runs_and_is_recorded(tmp_path):
    root = """
    parallel:
      - {skill: swing, in: {steps: 4}}
      - {skill: finish, in: {steps: 4}}
      - {skill: restart, in: {steps: 4}}
      - {skill: swing, name: done, in: {steps: 0}}
    """
    rehearsal = paused_at(tmp_path, 1, root)
    rehearsal.run()
    paused, resumed = rehearsal.pauses
    assert (paused.state, paused.by, resumed.state, resumed.by) == (
        *("paused", "the door"),
        *("resumed", "the operator"),
    )
    assert paused.time_s <= resumed.time_s
    paths = {rehearsal.tree.nodes[leaf.node].path: leaf.policy for leaf in paused.leaves}
    assert paths == {
        "m/swing": PausePolicy.HOLD,
        "m/finish": PausePolicy.FINISH,
        "m/restart": PausePolicy.STOP,
    }
    changes = [change for tick in rehearsal.seen.ticks[1:3] for change in tick.changes]
    assert NodeStatus.INVALID not in dict(changes).values()


def test_the_clock_goes_on_until_everything_rests(tmp_path):
    rehearsal = paused_at(tmp_path, 1, "{skill: swing, in: {steps: 4, coast: 7}}")
    result = rehearsal.run()
    assert rehearsal.seen.ticks[2].time_s == pytest.approx(0.2 + 0.7)
    assert result.rate.achieved_hz == pytest.approx(10.0)
    assert result.rate.overruns == 0


def test_a_pause_counts_for_no_timeout(tmp_path):
    root = "{timeout: {seconds: 0.55, child: {skill: swing, in: {steps: 4, coast: 50}}}}"
    rehearsal = paused_at(tmp_path, 1, root, "timeout_s: 0.7")
    rehearsal.runner._timeout_s = 0.7
    result = rehearsal.run()
    assert result.outcome is MissionOutcome.SUCCESS
    assert rehearsal.cell.clock.now_s() > 5.0


def test_time_that_is_skipped_is_no_time_of_the_mission():
    cell = ManualClock()
    clock = MissionClock(cell)
    cell.sleep_until(3.0)
    clock.skip(2.0)
    assert clock.now_s() == pytest.approx(1.0)
    clock.sleep_until(4.0)
    assert cell.now_s() == pytest.approx(6.0)


def test_a_stop_in_a_pause_ends_the_mission_and_resumes_nothing(tmp_path):
    control = Waiting(lambda: control.stop("the operator"))
    rehearsal = paused_at(tmp_path, 1, "{skill: swing, in: {steps: 9}}", control=control)
    result = rehearsal.run()
    assert result.outcome is MissionOutcome.ABORTED
    assert rehearsal.journal.lines[-2:] == ["hold pauses", "hold stops"]
    assert [pause.state for pause in rehearsal.pauses] == ["paused"]


def test_a_skill_that_cannot_pause_ends_the_mission_with_the_others_paused(tmp_path):
    root = "{parallel: [{skill: swing, name: stuck}, {skill: swing, name: fine}]}"
    rehearsal = paused_at(tmp_path, 1, root)
    stuck = rehearsal.tree.nodes[1].behaviour._skill

    def on_pause():
        raise OSError("no brake")

    stuck.on_pause = on_pause
    result = rehearsal.run()
    assert result.outcome is MissionOutcome.ERROR
    assert "m/stuck (swing): raised at tick 2: OSError: no brake" in result.reason
    assert rehearsal.journal.lines.count("hold pauses") == 1
    assert rehearsal.journal.lines.count("hold stops") == 2


def test_a_resume_before_a_skill_has_finished_gives_it_back_to_the_tree(tmp_path):
    control = RunControl()
    rehearsal = paused_at(tmp_path, 0, "{skill: finish, in: {steps: 6}}", control=control)
    note = rehearsal.journal.note

    def resume_at_third(line):
        note(line)
        if line == "finish 3":
            control.resume("a timer")

    rehearsal.journal.note = resume_at_third
    assert rehearsal.run().outcome is MissionOutcome.SUCCESS
    assert rehearsal.journal.lines == [f"finish {step}" for step in range(6)]


def test_pause_and_resume_from_another_thread(tmp_path):
    control = RunControl()
    rehearsal = paused_at(tmp_path, 1, "{skill: swing, in: {steps: 4}}", control=control)
    threading.Timer(0.05, control.resume).start()
    assert rehearsal.run().outcome is MissionOutcome.SUCCESS
    assert rehearsal.pauses[1].by == "another thread"
