"""Runs that were paused, forced, faulty, raising, cut off or resumed are ticked again alike."""

import shutil
from textwrap import dedent, indent

import pytest
from killed_toys import RealCell, WorldCell, resume, run, write_mission
from killed_toys import types as killed_types
from test_pausing import Waiting
from test_resuming import TREES
from toy_language import Journal, toy_types
from toy_missions import CELL, AtTick, skills_of_missions
from toy_runs import ToyCell

from executive.core.clock import MonotonicClock
from executive.core.errors import InputError
from executive.engine.checkpoints.choosing import checkpoints
from executive.engine.checkpoints.resuming import Consent
from executive.engine.debugging.debugger import Debugger
from executive.engine.faults.grammar import parse_injection
from executive.engine.loading.loader import load_mission
from executive.engine.nodes.builder import build
from executive.engine.recording.parts import parts_of
from executive.engine.recording.reader import Recording
from executive.engine.recording.writer import RecordingWriter
from executive.engine.running.control import RunControl
from executive.engine.running.mission_run import RunPlan, run_mission
from executive.inspector.past import PastRun
from executive.inspector.retick.retick import retick


class Ran:
    """One recorded run of a mission on a toy cell."""

    def __init__(self, folder, root, keys="", *, control=None, acts=None, faults=(), clock=None,
                 timeout_s=4.0):  # fmt: skip
        """Run it; `acts` are called after ticks, with the debugger."""
        (folder / "toy_cell.yaml").write_text(CELL)
        body = indent(dedent(root).strip(), "  ")
        head = f"format: 1\nmission: m\ncell: toy_cell\ntick_hz: 10\n{dedent(keys).strip()}"
        (folder / "m.yaml").write_text(f"{head}\nroot:\n{body}\n")
        mission = load_mission(folder / "m.yaml", skills=skills_of_missions(), types=toy_types())
        cell = ToyCell(clock) if clock else ToyCell()
        tree = build(mission, devices={"journal": Journal()}, clock=cell.clock)
        control = control or RunControl()
        debugger = Debugger(tree, control)
        plan = RunPlan(
            mission=mission, seed=0, inputs={}, scenario={}, timeout_s=timeout_s,
            recording=folder / "m.mcap", faults=tuple(parse_injection(text) for text in faults),
        )  # fmt: skip
        given = {
            tick: (lambda act=act: act(debugger, control)) for tick, act in (acts or {}).items()
        }
        run_mission(plan, tree, cell, control, (AtTick(given),), debugger)
        self.past = PastRun(Recording.open(folder / "m.mcap"))

    def retick(self):
        """Tick it again."""
        return retick(self.past, toy_types())

    def answered(self, name):
        """Return what a node answered, tick by tick."""
        node = self.past.names.node(name)
        return [self.past.index.answer(node, tick).value for tick in range(len(self.past.index))]


BUSY = """
retry:
  times: 3
  delay_s: 0.25
  child:
    sequence:
      children:
        - {skill: work, name: one, in: {label: one, ticks: 2}, out: {label: $seen}}
        - {when: seen == 'one', name: right}
        - timeout:
            name: late
            seconds: 0.85
            child: {skill: work, name: two, in: {label: two, ticks: 5}, out: {label: $two}}
        - {set: {n: "1"}, name: count}
"""


def force(pattern, answer, *, once):
    return lambda debugger, _: debugger.force(pattern, answer, once=once, by="the test")


@pytest.mark.parametrize("pattern", ["right", "one", "late", "two", "count", "sequence"])
@pytest.mark.parametrize("answer", ["success", "failure", "running"])
@pytest.mark.parametrize("once", [True, False])
def test_forced_answers_are_given_again(tmp_path, pattern, answer, once):
    acts = {
        1: force(pattern, answer, once=once),
        8: lambda debugger, _: debugger.unforce(pattern, by="me"),
    }
    ran = Ran(tmp_path, BUSY, acts=acts)
    assert ran.retick().identical


@pytest.mark.parametrize(
    "fault",
    [
        *("two: fail@1", "late: fail@1", "right: fail", "one: hang@1", "two: delay 0.35"),
        *(
            "late: delay 0.25@1",
            "sequence: delay 0.15",
            "two: raise@1",
            "right: raise",
            "late: raise@1",
        ),
        *('key seen: value "none"@1', "key seen: drop@1", "key n: value 7", "key two: drop"),
    ],
)
@pytest.mark.parametrize("on_error", ["end", "fail"])
def test_injected_faults_happen_again(tmp_path, fault, on_error):
    ran = Ran(tmp_path, BUSY, f"on_error: {on_error}", faults=[fault])
    assert ran.retick().identical


RAISING = """
selector:
  children:
    - reactive_sequence:
        - {skill: work, name: door, in: {label: door, ticks: 1}}
        - {skill: breaks, in: {after: 3}}
    - {when: nothing == 1, name: unknown}
    - {skill: work, name: last, in: {label: last, ticks: 2}}
"""


@pytest.mark.parametrize("on_error", ["end", "fail"])
def test_what_was_raised_is_raised_again(tmp_path, on_error):
    ran = Ran(
        tmp_path, RAISING, f"on_error: {on_error}\nin: {{nothing: {{type: str, default: a}}}}"
    )
    assert any(ran.past.index.faults)
    assert ran.retick().identical


def test_a_skill_that_raised_when_it_was_halted_does_so_again(tmp_path):
    root = """
    parallel:
      fail: 1
      children:
        - {skill: breaks, in: {after: 9}}
        - {skill: work, in: {label: a, ticks: 3, fails: 9}}
        - {skill: work, name: other, in: {label: b, ticks: 30}}
    """
    ran = Ran(tmp_path, root)
    assert any(
        "valve" in fault.message for faults in ran.past.index.faults.values() for fault in faults
    )
    assert ran.retick().identical


@pytest.mark.parametrize("skill", ["swing", "finish", "restart"])
def test_pauses_are_left_out_again(tmp_path, skill):
    root = f"""
    parallel:
      - {{skill: {skill}, in: {{steps: 4, coast: 3}}}}
      - {{timeout: {{seconds: 0.75, child: {{skill: swing, name: s, in: {{steps: 6}}}}}}}}
      - {{wait: 0.4}}
      - {{retry: {{times: 3, delay_s: 0.2, child: {{fail: no.way}}}}}}
    """

    def pause(_, control):
        control.pause("the door")

    ran = Ran(tmp_path, root, control=Waiting(), acts={1: pause, 3: pause})
    assert ran.retick().identical


def test_a_clock_that_goes_on_during_a_tick_changes_nothing(tmp_path):
    root = """
    parallel:
      - {repeat: {times: 4, child: {wait: 0.1}}}
      - {timeout: {seconds: 0.3, child: {wait: forever}}}
      - {retry: {times: 4, delay_s: 0.1, child: {fail: no.way}}}
    """
    ran = Ran(tmp_path, root, clock=MonotonicClock())
    assert ran.retick().identical


@pytest.mark.parametrize("end", ["stop", "emergency_stop"])
def test_a_run_that_was_stopped_is_stopped_again(tmp_path, end):
    def stop(_, control):
        getattr(control, end)("the operator")

    ran = Ran(tmp_path, BUSY, acts={3: stop})
    assert ran.retick().identical


def test_a_run_that_was_killed_is_ticked_again_as_far_as_it_goes(tmp_path):
    ran = Ran(tmp_path, BUSY)
    whole = (tmp_path / "m.mcap").read_bytes()
    live = tmp_path / "live.mcap"
    header = ran.past.recording.header
    writer = RecordingWriter(live, header)
    for tick in list(ran.past.recording.ticks())[:4]:
        writer.on_tick(tick)
    cut = tmp_path / "cut.mcap"
    shutil.copy(live, cut)
    writer.close()
    assert len(whole) > cut.stat().st_size
    found = retick(PastRun.open(cut), toy_types())
    assert found.identical
    assert found.ticks == 4
    assert "killed" in found.recorded_end


def test_a_recording_without_sources_is_refused(tmp_path):
    ran = Ran(tmp_path, BUSY)
    past = ran.past
    past.recording.header = past.recording.header.model_copy(update={"sources": ()})
    with pytest.raises(InputError, match="holds no sources"):
        ran.retick()
    nodes = tuple(reversed(Recording.open(tmp_path / "m.mcap").header.nodes))
    again = PastRun(Recording.open(tmp_path / "m.mcap"))
    again.index.nodes = nodes
    with pytest.raises(InputError, match="do not give the tree that was recorded"):
        retick(again, toy_types())


@pytest.mark.parametrize("kind", ["sequence", "selector", "loops", "for_each", "clocks", "once"])
@pytest.mark.parametrize("cell", [WorldCell, RealCell])
def test_resumed_runs_are_ticked_again_as_one(tmp_path, kind, cell):
    original, _ = run(write_mission(tmp_path, TREES[kind]), tmp_path / "one.mcap", cell())
    for number, info in enumerate(checkpoints(original)):
        consent = Consent(as_it_stands=cell is RealCell)
        resumed, _ = resume(
            tmp_path / "one.mcap", tmp_path / f"{number}.mcap", wanted=str(info), cell=cell(),
            consent=consent,
        )  # fmt: skip
        assert resumed.header.resumed_from is not None
        assert retick(PastRun(resumed), killed_types()).identical


def test_a_recording_of_several_parts_is_ticked_again_as_one(tmp_path):
    ran = Ran(tmp_path, BUSY)
    recording = ran.past.recording
    with RecordingWriter(tmp_path / "p.mcap", recording.header, part_bytes=1000) as writer:
        for tick in recording.ticks():
            writer.on_tick(tick)
    assert len(parts_of(tmp_path / "p.mcap")) > 1
    found = retick(PastRun.open(tmp_path / "p.mcap"), toy_types())
    assert found.identical
    assert found.ticks == ran.retick().ticks
