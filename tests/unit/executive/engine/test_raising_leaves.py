"""A node that raises ends the mission or fails, as the mission says."""

import pytest
from toy_missions import Rehearsal

from executive.engine.nodes.supervision import RAISED
from executive.engine.running.runner import MissionOutcome

TRY = "{selector: [{skill: breaks, in: {after: 1}}, {skill: swing, in: {steps: 2}}]}"


def test_by_default_a_node_that_raises_ends_the_mission(tmp_path):
    rehearsal = Rehearsal(tmp_path, TRY)
    result = rehearsal.run()
    assert result.outcome is MissionOutcome.ERROR
    assert result.reason.startswith("m/breaks (breaks): raised at tick 1: ValueError: broken wire")
    assert rehearsal.journal.lines == ["breaks stops"]
    assert rehearsal.cell.calls == ["stop"]


def test_on_error_fail_lets_the_mission_go_on_with_the_fault_recorded(tmp_path):
    rehearsal = Rehearsal(tmp_path, TRY, "on_error: fail")
    result = rehearsal.run()
    assert result.outcome is MissionOutcome.SUCCESS
    assert result.errors == ()
    assert rehearsal.journal.lines == ["breaks stops", "hold 0", "hold 1"]
    tick = rehearsal.seen.ticks[1]
    assert [(fault.path, fault.message) for fault in tick.faults] == [
        ("m/breaks", "ValueError: broken wire"),
        ("m/breaks", "OSError: valve"),
    ]
    assert "broken wire" in tick.faults[0].traceback
    (outcome,) = (end for end in tick.outcomes if end.reason is not None)
    assert (outcome.reason.code, outcome.reason.text) == (RAISED, "ValueError: broken wire")
    assert [(error.path, error.tick) for error in result.survived] == [("m/breaks", 1)] * 2


def test_the_reason_reaches_the_mission(tmp_path):
    result = Rehearsal(tmp_path, "{skill: breaks}", "on_error: fail").run()
    assert result.outcome is MissionOutcome.FAILURE
    assert result.reason == "m: node.raised: ValueError: broken wire"


@pytest.mark.parametrize(
    "leaf", ["{when: missing}", "{set: {copy: missing}}", "{skill: work, in: {label: $missing}}"]
)
def test_conditions_and_inputs_that_cannot_be_read_fail_too(tmp_path, leaf):
    value = "\"'x'\"" if "label" in leaf else '"true"'
    root = f"""
    sequence:
      - force_success: {{child: {{when: "false", on_success: {{missing: {value}}}}}}}
      - force_success: {{child: {leaf}}}
      - {{skill: swing, in: {{steps: 1}}}}
    """
    assert Rehearsal(tmp_path, root).run().outcome is MissionOutcome.ERROR
    rehearsal = Rehearsal(tmp_path, root, "on_error: fail")
    assert rehearsal.run().outcome is MissionOutcome.SUCCESS
    assert "missing" in str(rehearsal.seen.ticks[0].faults)


UNWRITTEN = """force_success:
          child: {when: "false", on_success: {missing: "true", few: "2", some: "[1]"}}"""
RAISING = {
    "if": "{skill: swing, if: missing}",
    "while": "{skill: swing, in: {steps: 9}, while: spare == 0 or missing}",
    "on_start": "{skill: swing, on_start: {copy: missing}}",
    "on_success": "{skill: swing, in: {steps: 1}, on_success: {copy: missing}}",
    "on_failure": "{when: missing, on_failure: {copy: missing}}",
    "retry": "{retry: {times: $few, child: {skill: swing}}}",
    "for_each": "{for_each: {item: $one, in: $some, child: {skill: swing}}}",
    "switch": '{switch: {on: missing, cases: {"true": {skill: swing}}}}',
    "reactive_switch": """
        {reactive_switch: {on: spare == 0 or missing, cases: {"true": {skill: swing}}}}""",
}


@pytest.mark.parametrize("node", RAISING.values(), ids=RAISING)
def test_guards_and_decorators_that_raise_fail_too(tmp_path, node):
    root = f"""
    sequence:
      - {UNWRITTEN}
      - set: {{spare: 0}}
      - parallel:
          children:
            - selector: [{node}, {{wait: 0}}]
            - sequence: [{{wait: 0.3}}, {{set: {{spare: 1}}}}]
    """
    rehearsal = Rehearsal(tmp_path, root, "on_error: fail")
    result = rehearsal.run()
    assert result.outcome is MissionOutcome.SUCCESS, result.reason
    assert "has no value" in str([tick.faults for tick in rehearsal.seen.ticks])
    reasons = [end.reason for tick in rehearsal.seen.ticks for end in tick.outcomes if end.reason]
    assert RAISED in [reason.code for reason in reasons]
    assert rehearsal.journal.lines.count("hold stops") == (node.count("spare") > 0)
    assert Rehearsal(tmp_path, root).run().outcome is MissionOutcome.ERROR


def test_what_raises_while_it_is_halted_ends_the_mission_all_the_same(tmp_path):
    root = f"""
    sequence:
      - {UNWRITTEN}
      - parallel:
          succeed: any
          children: [{{skill: swing, in: {{steps: 9}}, on_halt: {{copy: missing}}}}, {{wait: 0.1}}]
    """
    result = Rehearsal(tmp_path, root, "on_error: fail").run()
    assert result.outcome is MissionOutcome.ERROR
    assert "missing" in result.reason


def test_an_exit_ends_the_mission_whatever_it_says_and_stops_every_leaf(tmp_path):
    root = """
    parallel:
      - {skill: swing, in: {steps: 9}}
      - {skill: breaks, in: {after: 1, badly: true}}
    """
    rehearsal = Rehearsal(tmp_path, root, "on_error: fail")
    result = rehearsal.run()
    assert result.outcome is MissionOutcome.ERROR
    assert "m/breaks (breaks): raised at tick 1: SystemExit: 3" in result.reason
    assert sorted(rehearsal.journal.lines) == ["breaks stops", "hold 0", "hold 1", "hold stops"]
    assert rehearsal.cell.calls == ["stop"]
