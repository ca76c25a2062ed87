"""Leaves of the language, and the decorators that note or pass on what runs."""

import pytest
from toy_language import Journal

from executive.core.clock import ManualClock
from executive.engine.language.counts import NodeCounts
from executive.engine.nodes.builder import build
from executive.engine.running.probe import TreeProbe
from executive.engine.ticks import NodeStatus


def test_wait_runs_on_the_clock_of_the_cell(bench):
    bench.build("wait: 0.25")
    assert bench.tick(4) == ["RUNNING", "RUNNING", "RUNNING", "SUCCESS"]
    bench.build("repeat: {times: 2, child: {wait: 0.15}}")
    assert bench.tick(5) == ["RUNNING", "RUNNING", "RUNNING", "RUNNING", "RUNNING"]
    assert bench.tick() == ["SUCCESS"]
    bench.build("wait: forever")
    assert set(bench.tick(30)) == {"RUNNING"}


def test_wait_for_runs_until_an_expression_is_true(bench):
    tree = bench.build("wait_for: x > 1", "in: {x: {type: int}}", x=1)
    assert bench.tick(2) == ["RUNNING", "RUNNING"]
    tree.scope.write("x", 2, "test")
    assert bench.tick() == ["SUCCESS"]
    assert any("expected true or false" in fault for fault in bench.faults("wait_for: 3"))


def test_fail_gives_its_reason(bench):
    tree = bench.build("{fail: part.missing, text: no part in sight}")
    assert bench.tick() == ["FAILURE"]
    assert str(tree.root.outcome.reason) == "part.missing: no part in sight"
    assert "expected a code such as part.missing" in bench.faults("fail: No part")[0]


def test_unset_takes_values_away(bench):
    tree = bench.build("sequence: [{set: {a: 1, b: 2}}, {unset: [a, b]}, {when: not written(a)}]")
    assert bench.tick() == ["SUCCESS"]
    assert "b" not in tree.scope
    writes = tree.blackboard.drain_writes()
    assert [(write.key, write.writer) for write in writes[2:]] == [
        *(("t:a", "t/unset"), ("t:b", "t/unset")),
    ]


@pytest.mark.parametrize(
    ("root", "fault"),
    [
        ("unset: y", "t: unset: nothing in this tree writes 'y'"),
        ("unset: x", "'x' is an input of the tree, which keeps its value"),
        (
            "sequence: [{set: {k: 1}}, {unset: k}, {when: k > 0}]",
            "t/when: when: $k has no value yet",
        ),
    ],
)
def test_faults_of_unset(bench, root, fault):
    found = bench.faults(root, "in: {x: {type: int, default: 1}}")
    assert any(fault in one for one in found), found


def draws(bench, seed, path="t"):
    program = bench.load(
        "repeat: {times: forever, child: {chance: 0.3}}".replace("repeat", "retry")
    )
    tree = build(program, devices={"journal": Journal()}, clock=ManualClock(), seed=seed)
    answers = []
    for _ in range(400):
        tree.root.tick_once()
        answers.append(tree.root.status.value == "SUCCESS")
    return answers


def test_chance_is_that_of_the_seed(bench):
    assert draws(bench, 1) == draws(bench, 1)
    assert draws(bench, 1) != draws(bench, 2)
    # 99.9 % of all seeds are nearer than this to 0.3 (binomial, n = 400).
    assert abs(sum(draws(bench, 5)) / 400 - 0.3) < 0.077


def test_chances_of_two_nodes_are_their_own(bench):
    program = bench.load(
        "repeat: {times: forever, child: {parallel: {succeed: any, fail: all, children: "
        "[{chance: 0.5}, {chance: 0.5}, {when: true}], on_done: wait}}}"
    )
    tree = build(program, devices={}, clock=ManualClock(), seed=3)
    one, two = (node.behaviour for node in tree.nodes if node.kind == "chance")
    pairs = []
    for _ in range(50):
        tree.root.tick_once()
        pairs.append((one.status, two.status))
    assert len({pair[0] == pair[1] for pair in pairs}) == 2


def test_chance_of_none_and_of_all(bench):
    assert bench.run("chance: 0")[0] == "FAILURE"
    assert bench.run("chance: 1")[0] == "SUCCESS"


def test_observe_notes_status_and_counts(bench):
    tree = bench.build(
        """
        reactive_selector:
          - {when: go}
          - observe:
              status: $status
              counts: $counts
              child: {skill: work, in: {label: a, ticks: 3}}
        """,
        "in: {go: {type: bool}}",
        go=False,
    )
    bench.tick(2)
    assert tree.scope["status"] is NodeStatus.RUNNING
    assert tree.scope["counts"] == NodeCounts(ticks=2, running=2)
    tree.scope.write("go", True, "test")
    bench.tick(2)
    assert tree.scope["status"] is NodeStatus.INVALID
    assert tree.scope["counts"] == NodeCounts(ticks=2, running=2, halts=1)


def test_what_observe_notes_is_typed(bench):
    root = "sequence: [{observe: {status: $s, child: {when: true}}}, {when: 's == \"DONE\"'}]"
    assert "NodeStatus has no value 'DONE'" in bench.faults(root)[0]
    assert "needs a key" in bench.faults("observe: {child: {when: true}}")[0]
    tree = bench.build("observe: {counts: $c, child: {when: true}}", "out: {c: {type: NodeCounts}}")
    bench.tick()
    assert tree.outputs()["c"].successes == 1


def test_run_once_may_keep_only_a_success(bench):
    child = "{skill: work, in: {label: a, fails: 2}}"
    bench.build(f"run_once: {{until: success, child: {child}}}")
    assert bench.tick(5) == ["FAILURE", "FAILURE", "SUCCESS", "SUCCESS", "SUCCESS"]
    assert bench.journal.lines.count("a starts") == 3


@pytest.mark.parametrize(("kind", "says"), [("success", "SUCCESS"), ("failure", "FAILURE")])
def test_a_running_child_is_answered_for_and_runs_on(bench, kind, says):
    bench.build(f"running_is_{kind}: {{child: {{skill: work, in: {{label: a, ticks: 3}}}}}}")
    assert bench.tick(3) == [says, says, "SUCCESS"]
    assert bench.journal.lines == ["a starts", "a ends"]


def test_a_child_that_is_answered_for_is_halted_once_with_its_node(bench):
    tree = bench.build("running_is_success: {child: {skill: work, in: {label: a, ticks: 9}}}")
    bench.tick(2)
    for _ in range(2):
        tree.root.stop(tree.root.status.INVALID)
    assert bench.journal.lines == ["a starts", "a stops"]


BUSY = "on_start: {busy: true}, finally: {busy: false}"


def test_on_start_and_finally_bracket_a_node(bench):
    tree = bench.build(
        f"""
        reactive_selector:
          - {{when: go}}
          - {{skill: work, in: {{label: a, ticks: 3}}, {BUSY}, on_halt: {{busy: 3}}}}
        """,
        "in: {go: {type: bool}}",
        go=False,
    )
    bench.tick()
    assert tree.scope["busy"] is True
    tree.scope.write("go", True, "test")
    bench.tick()
    assert tree.scope["busy"] is False
    for fails, _ in ((0, "SUCCESS"), (1, "FAILURE")):
        tree = bench.build(f"{{skill: work, in: {{label: a, fails: {fails}}}, {BUSY}}}")
        bench.tick()
        assert tree.scope["busy"] is False


def test_on_start_is_not_set_when_a_guard_refuses(bench):
    tree = bench.build(f"{{skill: work, in: {{label: a}}, if: 1 > 2, {BUSY}}}")
    bench.tick()
    values = [write.value for write in tree.blackboard.drain_writes()]
    assert values == [False]


def test_keys_of_on_start_can_be_read_inside(bench):
    assert bench.faults("sequence: {on_start: {n: 1}, children: [{when: n > 0}]}") == []


def ticked(tree, count):
    """Tick a tree as a run does, and return what the skills noted after each tick."""
    probe = TreeProbe(tree)
    for number in range(count):
        _, error = probe.tick(number, 0.1 * number)
        assert error is None
        yield probe


def test_a_child_that_is_answered_for_is_halted_by_the_first_tick_that_leaves_it(bench):
    tree = bench.build(
        """
        reactive_selector:
          - {when: go}
          - running_is_failure: {child: {skill: work, in: {label: a, ticks: 9}}}
          - {wait: forever}
        """,
        "in: {go: {type: bool}}",
        go=False,
    )
    ticks = ticked(tree, 4)
    next(ticks)
    next(ticks)
    assert bench.journal.lines == ["a starts"]
    tree.scope.write("go", True, "test")
    next(ticks)
    assert bench.journal.lines == ["a starts", "a stops"]
    tree.scope.write("go", False, "test")
    next(ticks)
    assert bench.journal.lines == ["a starts", "a stops", "a starts"]


def test_a_sequence_that_went_on_halts_what_was_answered_for(bench):
    tree = bench.build(
        "sequence: [{running_is_success: {child: {skill: work, in: {label: a, ticks: 9}}}}, "
        "{wait: forever}]"
    )
    list(ticked(tree, 3))
    assert bench.journal.lines == ["a starts", "a stops"]
