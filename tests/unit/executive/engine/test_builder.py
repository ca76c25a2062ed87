"""Built trees: devices, skills in them, the blackboard and its writers."""

import pytest

from executive.core.clock import ManualClock
from executive.core.errors import DocumentError, InputError
from executive.engine.nodes.builder import build

WORK = "{skill: work, in: {label: a, ticks: 3}}"


def test_devices_are_bound_by_name_and_type(bench):
    program = bench.load("sequence: [{skill: work, in: {label: a}}, {skill: find}]")
    with pytest.raises(DocumentError) as missing:
        build(program, devices={"jurnal": 1}, clock=ManualClock())
    assert "t/work: the cell has no device 'journal' (Journal); did you mean 'jurnal'?" in str(
        missing.value
    )
    with pytest.raises(DocumentError, match="device 'journal': expected Journal, got 1"):
        build(program, devices={"journal": 1}, clock=ManualClock())


@pytest.mark.parametrize(
    ("inputs", "message"),
    [
        ({}, "t: input 'n' is needed, and has no default"),
        ({"n": "x"}, "t: input 'n': expected int, got 'x'"),
        ({"n": 1, "m": 2}, "t: unknown input 'm'; known: n"),
    ],
)
def test_inputs_of_a_mission_are_checked(bench, inputs, message):
    with pytest.raises(InputError) as refused:
        bench.build("{when: n > 1}", "in: {n: {type: int}}", **inputs)
    assert message in str(refused.value)


def test_nodes_are_listed_depth_first_with_their_places(bench):
    tree = bench.build(
        """
        sequence:
          - retry: {times: 2, child: {when: true}}
          - {skill: work, name: push, in: {label: a}, if: 1 < 2}
        """
    )
    found = [(n.index, n.path, n.kind, n.type, n.parent, n.acts) for n in tree.nodes]
    assert found == [
        (0, "t", "sequence", "sequence", None, False),
        (1, "t/retry", "retry", "retry", 0, False),
        (2, "t/retry/when", "when", "when", 1, False),
        (3, "t/push.guard", "guard", "guard", 0, False),
        (4, "t/push", "skill", "work", 3, True),
    ]
    assert [(n.line, n.column) for n in tree.nodes] == [(5, 3), (6, 7), (6, 32), (7, 7), (7, 7)]
    assert tree.nodes[0].behaviour is tree.root
    assert all(
        n.behaviour.children == [m.behaviour for m in tree.nodes if m.parent == n.index]
        for n in tree.nodes
    )


def test_outputs_are_written_with_key_and_writer(bench):
    tree = bench.build("{skill: find, out: {distance: $d}}", "out: {d: {type: float}}")
    assert tree.outputs() == {}
    bench.tick()
    (write,) = tree.blackboard.drain_writes()
    assert (write.key, write.value, write.writer) == ("t:d", 2.0, "t")
    assert tree.blackboard.drain_writes() == []
    assert tree.outputs() == {"d": 2.0}


def test_inputs_of_a_mission_are_writes_of_nobody(bench):
    tree = bench.build("{when: n > 1}", "in: {n: {type: int}}", n=3)
    (write,) = tree.blackboard.drain_writes()
    assert (write.key, write.value, write.writer) == ("t:n", 3, "")


def test_two_trees_do_not_share_a_blackboard(bench):
    one = bench.build("{skill: find, out: {distance: $d}}")
    bench.tick()
    two = bench.build("{skill: find, out: {distance: $d}}")
    assert "d" in one.scope
    assert "d" not in two.scope


def test_a_skill_is_started_once_and_halted_once(bench):
    tree = bench.build(WORK)
    bench.tick(2)
    tree.root.stop(tree.root.status.INVALID)
    tree.root.stop(tree.root.status.INVALID)
    assert bench.journal.lines == ["a starts", "a stops"]
    assert bench.tick(3) == ["RUNNING", "RUNNING", "SUCCESS"]
    tree.root.stop(tree.root.status.INVALID)
    assert bench.journal.lines == ["a starts", "a stops", "a starts", "a ends"]


def test_skill_says_why_it_failed(bench):
    tree = bench.build("{skill: work, in: {label: a, fails: 1}}")
    assert bench.tick() == ["FAILURE"]
    assert str(tree.root.outcome.reason) == "work.failed: a"


def test_skill_that_raises_is_halted_when_it_is_stopped(bench):
    tree = bench.build("{skill: work, in: {label: a, ticks: 2, raises: true}}")
    bench.tick()
    with pytest.raises(RuntimeError, match="broken"):
        bench.tick()
    tree.root.stop(tree.root.status.INVALID)
    assert bench.journal.lines == ["a starts", "a stops"]


def test_output_of_another_type_is_an_error(bench):
    bench.build("{skill: liar}")
    with pytest.raises(TypeError, match="output 'mass': expected float, got 'heavy'"):
        bench.tick()


def test_key_without_a_value_is_an_error_that_names_it(bench):
    bench.build(
        "sequence: [{selector: [{sequence: [{when: 1 > 2}, {set: {x: 1}}]}, {when: true}]}, "
        "{when: x > 0}]"
    )
    with pytest.raises(InputError, match="'x > 0': 'x' has no value: nothing has written it yet"):
        bench.tick()


def test_condition_that_is_neither_true_nor_false_is_an_error(bench):
    bench.build("{when: x}", "in: {x: {type: any}}", x=3)
    with pytest.raises(InputError, match="'x': expected true or false, got 3"):
        bench.tick()


def test_false_condition_says_so(bench):
    tree = bench.build("{when: n > 1}", "in: {n: {type: int}}", n=1)
    assert bench.tick() == ["FAILURE"]
    assert str(tree.root.outcome.reason) == "condition.false: n > 1 is false"


def test_literals_reach_skills_with_the_declared_type(bench):
    root = "{skill: sort, in: {colour: green, limit: 2, parts: [{mass_kg: 1, colour: red}]}}"
    assert bench.run(root)[0] == "SUCCESS"


def test_doubled_dollar_is_a_literal(bench):
    assert bench.run("{skill: work, in: {label: $$a}}")[1] == ["$a starts", "$a ends"]
