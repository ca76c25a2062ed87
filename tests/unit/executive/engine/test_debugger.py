"""A mission pauses where it was told to, and goes on as far as it was told to."""

import threading
import time

import pytest
from toy_language import Bench
from toy_runs import ToyCell

from executive.core.errors import InputError
from executive.engine.debugging.debugger import Debugger
from executive.engine.debugging.stepping import Step
from executive.engine.running.control import RunControl
from executive.engine.running.runner import Runner

TREE = """
sequence:
  children:
    - {set: {count: 0}, name: begin}
    - repeat:
        name: rounds
        times: 3
        child:
          sequence:
            name: round
            children:
              - {set: {count: count + 1}, name: add}
              - {skill: work, name: labour, in: {label: a, ticks: 2}}
    - {when: count == 3, name: check}
"""
LIMIT_S = 10.0


class Debugged:
    """A run in a thread of its own, commanded from the test's."""

    def __init__(self, bench):
        self.bench = bench
        self.control = RunControl()
        self.tree = bench.build(TREE)
        self.debugger = Debugger(self.tree, self.control)
        self.ticks = []
        cell = ToyCell()
        cell.devices = {"journal": bench.journal}
        self.runner = Runner(
            self.tree,
            cell,
            tick_hz=10.0,
            observers=(self,),
            control=self.control,
            debugger=self.debugger,
        )
        self.result = None
        self._thread = threading.Thread(target=self._run, daemon=True)

    def on_tick(self, tick):
        self.ticks.append(tick)

    def on_streams(self, messages):
        pass

    def start(self):
        self._thread.start()
        return self

    def stands(self):
        """Wait until the run is paused; return where."""
        end_s = time.monotonic() + LIMIT_S
        while time.monotonic() < end_s:
            standing = self.debugger.standing
            if standing is not None:
                return standing
            if not self._thread.is_alive():
                raise AssertionError(f"the run has ended: {self.result}")
            time.sleep(0.002)
        raise AssertionError("the run never paused")

    def finish(self):
        self.debugger.go_on("test")
        self._thread.join(LIMIT_S)
        assert self.result is not None
        return self.result

    def _run(self):
        self.result = self.runner.run()


@pytest.fixture
def run(tmp_path):
    return Debugged(Bench(tmp_path))


def test_pauses_before_a_node_starts_and_only_then(run):
    number = run.debugger.add("labour")
    run.start()
    for count in (1, 2, 3):
        standing = run.stands()
        assert (standing.node, standing.answered) == ("t/rounds/round/labour", False)
        assert run.bench.journal.lines.count("a starts") == count - 1
        if count < 3:
            run.debugger.go_on("test")
    assert run.finish().outcome == "success"
    assert run.debugger.breakpoints() == [{"number": number, "text": "labour", "hits": 3}]


def test_pauses_where_a_condition_holds(run):
    run.debugger.add("labour when count == 2")
    run.start().stands()
    assert run.tree.scope["count"] == 2
    assert run.finish().outcome == "success"


@pytest.mark.parametrize(
    ("text", "node"),
    [
        ("round on success", "t/rounds/round"),
        ("labour on end", "t/rounds/round/labour"),
        ("check", "t/check"),
    ],
)
def test_pauses_when_a_node_has_ended(run, text, node):
    run.debugger.add(text)
    assert run.start().stands().node == node
    assert run.debugger.standing.answered is ("on" in text)
    run.debugger.remove(1)
    assert run.finish().outcome == "success"


def test_pauses_after_a_write_and_at_a_tick(run):
    run.debugger.add("on write count when count == 2")
    run.debugger.add("on tick 4")
    run.start().stands()
    assert run.tree.scope["count"] == 2
    first = len(run.ticks)
    run.debugger.go_on("test")
    while run.debugger.standing is None or "tick 4" not in run.debugger.standing.why:
        time.sleep(0.002)
    assert first <= len(run.ticks) == 4
    assert run.finish().outcome == "success"


def test_steps_into_over_and_out_of_nodes(run):
    run.debugger.add("round when count == 1")
    seen = [run.start().stands().node]
    for step in (Step.INTO, Step.OVER, Step.OUT, Step.OVER):
        run.debugger.step(step, "test")
        seen.append(run.stands().node)
    names = [path.rpartition("/")[2] for path in seen]
    # `round` begins again with its second round; `add` is inside it, `labour` beside that.
    assert names[:3] == ["round", "add", "labour"]
    assert names[3] in ("t", "rounds", "round")
    assert run.finish().outcome == "success"


def test_steps_one_tick_at_a_time(run):
    run.control.pause("test")
    run.start().stands()
    for count in (1, 2, 3):
        run.debugger.step(Step.TICK, "test")
        run.stands()
        assert len(run.ticks) == count
    assert run.finish().outcome == "success"


def test_forced_answers_take_the_place_of_a_node(run):
    assert run.debugger.force("labour", "success", once=False, by="test") == [
        "t/rounds/round/labour"
    ]
    run.start()._thread.join(LIMIT_S)
    assert run.result.outcome == "success"
    assert run.bench.journal.lines == []


def test_a_forced_failure_says_so(run):
    run.debugger.force("check", "failure", once=True, by="test")
    run.start()._thread.join(LIMIT_S)
    assert run.result.outcome == "failure"
    assert "debug.forced" in run.result.reason


def test_a_running_node_is_halted_when_its_answer_is_forced(run):
    run.debugger.add("on tick 1")
    run.start().stands()
    run.debugger.force("labour", "success", once=True, by="test")
    assert run.finish().outcome == "success"
    assert run.bench.journal.lines.count("a stops") == 1


def test_stop_in_the_middle_of_a_tick_ends_the_mission(run):
    run.debugger.add("labour")
    run.start().stands()
    run.control.stop("test")
    run._thread.join(LIMIT_S)
    assert run.result.outcome == "aborted"
    assert run.bench.journal.lines == []


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "expected"),
        ("on failur", "did you mean 'failure'"),
        ("labour on write x", "about no node"),
        ("on write", "expected what"),
        ("on slow fast", "expected a number"),
        ("labour on end x", "got 'x'"),
        ("on start", "the node that starts"),
        ("labour when count >", "not an expression"),
        ("labor", "did you mean 'labour'"),
    ],
)
def test_bad_breakpoints_are_answered(run, text, message):
    with pytest.raises(InputError, match=message):
        run.debugger.add(text)
