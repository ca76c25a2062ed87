"""Steps that take too long are recorded with the node to blame."""

import time

import pytest
from toy_missions import Rehearsal, Swing

from executive.core.outcome import success
from executive.engine.recording.messages import RecordedNode
from executive.engine.recording.slow import SlowLog
from executive.engine.ticks import SlowStep, Tick


@pytest.fixture
def laggard(monkeypatch):
    """Make a swing of n steps take n hundredths of a second in its first step."""

    def run(self, steps=5, coast=0, ending="success"):
        time.sleep(steps / 100.0)
        yield
        return success(steps=steps)

    run.__annotations__ = Swing.run.__annotations__
    monkeypatch.setattr(Swing, "run", run)


def slow_steps(rehearsal):
    rehearsal.run()
    nodes = rehearsal.tree.nodes
    return [
        (tick.number, nodes[step.node].path, step.budget_s)
        for tick in rehearsal.seen.ticks
        for step in tick.slow
    ]


def test_a_step_over_its_budget_is_recorded_with_its_node(tmp_path, laggard):
    root = """
    sequence:
      - {skill: swing, name: quick, in: {steps: 0}, budget_s: 0.02}
      - {skill: swing, name: lame, in: {steps: 4}, budget_s: 0.02}
    """
    assert slow_steps(Rehearsal(tmp_path, root)) == [(1, "m/lame", 0.02)]


def test_a_budget_is_that_of_the_node_else_of_the_skill_else_a_tick(tmp_path, laggard, monkeypatch):
    root = "{skill: swing, in: {steps: 3}, budget_s: 0.01}"
    assert slow_steps(Rehearsal(tmp_path, root)) == [(0, "m", 0.01)]
    root = "{skill: swing, in: {steps: 3}}"
    assert slow_steps(Rehearsal(tmp_path, root, "tick_hz: 50.0")) == [(0, "m", 0.02)]
    assert slow_steps(Rehearsal(tmp_path, root)) == []
    monkeypatch.setattr(Swing, "BUDGET_S", 0.015)
    assert slow_steps(Rehearsal(tmp_path, root)) == [(0, "m", 0.015)]


def test_the_report_names_the_slowest_first():
    nodes = [
        RecordedNode(path=path, name=path, kind="skill", type="x", parent=None, file="f", line=1)
        for path in ("a", "b")
    ]
    log = SlowLog(nodes)
    steps = (SlowStep(0, 0.2, 0.1), SlowStep(1, 0.9, 0.1), SlowStep(0, 0.3, 0.1))
    log.on_tick(Tick(0, 0.0, 0.0, slow=steps))
    told = [(node.path, node.times, node.worst_s) for node in log.reports()]
    assert told == [("b", 1, 0.9), ("a", 2, 0.3)]
