"""Nodes with one child, and guards around any node."""

import pytest


def test_retry_runs_the_child_again_until_it_succeeds(bench):
    answer, lines = bench.run("retry: {times: 5, child: {skill: work, in: {label: a, fails: 2}}}")
    assert answer == "SUCCESS"
    assert lines.count("a starts") == 3


def test_retry_fails_after_its_last_attempt(bench):
    answer, lines = bench.run("retry: {times: 3, child: {skill: work, in: {label: a, fails: 9}}}")
    assert answer == "FAILURE"
    assert lines.count("a starts") == 3


def test_retry_makes_at_most_one_attempt_in_a_tick(bench):
    bench.build("retry: {times: 3, child: {when: false}}")
    assert bench.tick(3) == ["RUNNING", "RUNNING", "FAILURE"]


def test_retry_waits_on_the_clock_of_the_cell(bench):
    bench.build("retry: {times: 2, delay_s: 0.25, child: {skill: work, in: {label: a, fails: 9}}}")
    assert bench.tick(4) == ["RUNNING", "RUNNING", "RUNNING", "FAILURE"]
    assert bench.journal.lines.count("a starts") == 2


def test_repeat_counts_successes(bench):
    answer, lines = bench.run("repeat: {times: 3, child: {skill: work, in: {label: a}}}")
    assert (answer, lines.count("a ends")) == ("SUCCESS", 3)
    assert bench.run("repeat: {times: 3, child: {when: false}}")[0] == "FAILURE"


def test_timeout_halts_the_child_on_the_clock_of_the_cell(bench):
    tree = bench.build("timeout: {seconds: 0.25, child: {skill: work, in: {label: a, ticks: 9}}}")
    assert bench.tick(4) == ["RUNNING", "RUNNING", "RUNNING", "FAILURE"]
    assert bench.journal.lines == ["a starts", "a stops"]
    assert str(tree.root.outcome.reason) == "timeout: not done after 0.25 s"


def test_timeout_gives_a_late_child_no_tick(bench):
    bench.build("timeout: {seconds: 0.15, child: {skill: work, in: {label: a, ticks: 3}}}")
    assert bench.tick(3) == ["RUNNING", "RUNNING", "FAILURE"]
    assert "a ends" not in bench.journal.lines


def test_timeout_starts_anew_with_every_activation(bench):
    answer, _ = bench.run(
        """
        repeat:
          times: 3
          child: {timeout: {seconds: 0.25, child: {skill: work, in: {label: a, ticks: 2}}}}
        """
    )
    assert answer == "SUCCESS"


def test_cooldown_fails_without_starting_the_child(bench):
    bench.build("cooldown: {seconds: 0.25, child: {skill: work, in: {label: a}}}")
    assert bench.tick(4) == ["SUCCESS", "FAILURE", "FAILURE", "SUCCESS"]
    assert bench.journal.lines.count("a starts") == 2


def for_each(bench, parts):
    root = "for_each: {item: $p, in: $parts, child: {skill: work, in: {label: $p}}}"
    return bench.run(root, "in: {parts: {type: 'list[any]'}}", parts=parts)


def test_for_each_runs_the_child_for_every_item(bench):
    answer, lines = for_each(bench, ["x", "y"])
    assert (answer, lines) == ("SUCCESS", ["x starts", "x ends", "y starts", "y ends"])


def test_for_each_succeeds_on_an_empty_list_without_starting_the_child(bench):
    assert for_each(bench, []) == ("SUCCESS", [])


def test_for_each_takes_none_as_an_item_like_any_other(bench):
    root = "for_each: {item: $p, in: [null, 1], child: {set: {last: p}}}"
    tree = bench.build(root)
    assert bench.tick(2) == ["RUNNING", "SUCCESS"]
    written = [write.value for write in tree.blackboard.drain_writes() if write.key == "t:p"]
    assert written == [None, 1]


def test_for_each_refuses_a_list_that_may_be_none(bench):
    faults = bench.faults(
        "for_each: {item: $p, in: $parts, child: {when: true}}",
        "in: {parts: {type: 'list[int] | None'}}",
    )
    assert faults == [
        "t: in: expected list[any], but $parts is list[int] | None, "
        "written by whoever uses this tree: it is an input"
    ]


def test_for_each_ends_with_the_first_failure(bench):
    answer, lines = bench.run(
        "for_each: {item: $n, in: [1, 2, 3], child: {sequence: ["
        "{skill: work, in: {label: x}}, {when: n < 2}]}}"
    )
    assert (answer, lines.count("x starts")) == ("FAILURE", 2)


def test_run_once_keeps_its_first_answer(bench):
    answer, lines = bench.run(
        "repeat: {times: 3, child: {run_once: {child: {skill: work, in: {label: a}}}}}"
    )
    assert (answer, lines.count("a starts")) == ("SUCCESS", 1)


@pytest.mark.parametrize(
    ("kind", "on_true", "on_false"),
    [
        ("inverter", "FAILURE", "SUCCESS"),
        ("force_success", "SUCCESS", "SUCCESS"),
        ("force_failure", "FAILURE", "FAILURE"),
    ],
)
def test_answers_are_turned_or_forced(bench, kind, on_true, on_false):
    assert bench.run(f"{kind}: {{child: {{when: true}}}}")[0] == on_true
    assert bench.run(f"{kind}: {{child: {{when: false}}}}")[0] == on_false


def test_forced_answers_wait_for_a_running_child(bench):
    bench.build("force_success: {child: {skill: work, in: {label: a, ticks: 2, fails: 9}}}")
    assert bench.tick(2) == ["RUNNING", "SUCCESS"]


GO = "in: {go: {type: bool}}"


def test_if_is_asked_once_before_the_node_starts(bench):
    root = "{skill: work, in: {label: a, ticks: 3}, if: go}"
    assert bench.run(root, GO, go=False) == ("FAILURE", [])
    tree = bench.build(root, GO, go=True)
    bench.tick()
    tree.scope.write("go", False, "test")
    assert bench.tick(2) == ["RUNNING", "SUCCESS"]


def test_unless_makes_the_node_succeed_without_starting(bench):
    root = "{skill: work, in: {label: a}, unless: go}"
    assert bench.run(root, GO, go=True) == ("SUCCESS", [])
    assert bench.run(root, GO, go=False) == ("SUCCESS", ["a starts", "a ends"])


def test_while_is_asked_in_every_tick_and_halts_the_node(bench):
    tree = bench.build("{skill: work, in: {label: a, ticks: 9}, while: go}", GO, go=True)
    assert bench.tick(2) == ["RUNNING", "RUNNING"]
    tree.scope.write("go", False, "test")
    assert bench.tick() == ["FAILURE"]
    assert bench.journal.lines == ["a starts", "a stops"]
    assert str(tree.root.outcome.reason) == "condition.false: go is false"


def test_guards_stand_on_blocks_and_subtrees_too(bench):
    bench.write_root("{skill: work, in: {label: u}}", name="u")
    assert bench.run("{subtree: u, if: 1 > 2}") == ("FAILURE", [])
    assert bench.run("sequence: {unless: 2 > 1, children: [{subtree: u}]}") == ("SUCCESS", [])


@pytest.mark.parametrize(("fails", "key"), [(0, "on_success"), (9, "on_failure")])
def test_keys_are_set_by_how_a_node_ends(bench, fails, key):
    tree = bench.build(
        f"{{skill: work, in: {{label: a, fails: {fails}}}, "
        "on_success: {end: '\"on_success\"'}, on_failure: {end: '\"on_failure\"'}}"
    )
    bench.tick()
    assert tree.scope["end"] == key


def test_on_halt_is_set_when_a_running_node_is_halted_and_only_then(bench):
    tree = bench.build(
        """
        reactive_selector:
          - {when: go}
          - {skill: work, in: {label: a, ticks: 9}, on_halt: {halted: true}}
        """,
        GO,
        go=False,
    )
    bench.tick()
    assert "halted" not in tree.scope
    tree.scope.write("go", True, "test")
    bench.tick()
    assert tree.scope["halted"] is True
    tree.blackboard.drain_writes()
    bench.tick()
    assert tree.blackboard.drain_writes() == []
