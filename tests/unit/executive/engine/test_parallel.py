"""Policies of parallel nodes."""

import pytest

S, F, R = "S", "F", "R"
ANSWERS = {S: "{when: true}", F: "{when: false}", R: "{skill: work, in: {label: r, ticks: 9}}"}


def first_tick(bench, policy, children):
    nodes = ", ".join(ANSWERS[child] for child in children)
    bench.build(f"parallel: {{{policy}children: [{nodes}]}}")
    return bench.tick()[0][0]


@pytest.mark.parametrize(
    ("policy", "children", "status"),
    [
        ("", [S, S], S),
        ("", [S, R], R),
        ("", [R, F], F),
        ("succeed: any, ", [R, S], S),
        ("succeed: any, ", [R, F], R),
        ("succeed: any, ", [F, F], F),
        ("succeed: any, ", [S, F], S),
        ("succeed: 2, ", [S, S, R], S),
        ("succeed: 2, ", [S, F, R], R),
        ("succeed: 2, ", [S, F, F], F),
        ("succeed: 2, fail: any, ", [S, F, R], F),
        ("succeed: 1, fail: any, ", [S, F, R], S),
        ("succeed: all, fail: all, ", [F, S, R], R),
        ("succeed: all, fail: all, ", [F, S, S], F),
        ("succeed: all, fail: 2, ", [F, R, R], R),
        ("succeed: all, fail: 2, ", [F, F, R], F),
        ("succeed: [when], ", [S, R], S),
        ("succeed: [when], ", [F, R], F),
        ("succeed: [work], ", [F, R], R),
        ("succeed: [when, when_2], ", [S, S, R], S),
    ],
)
def test_truth_table(bench, policy, children, status):
    assert first_tick(bench, policy, children) == status


def test_children_that_run_are_stopped_once_it_is_decided(bench):
    assert first_tick(bench, "succeed: any, ", [R, S]) == S
    assert bench.journal.lines == ["r starts", "r stops"]


def test_on_done_wait_lets_running_children_finish(bench):
    bench.build(
        """
        parallel:
          succeed: any
          on_done: wait
          children:
            - {when: true}
            - {skill: work, in: {label: w, ticks: 3, fails: 9}}
        """
    )
    assert bench.tick(3) == ["RUNNING", "RUNNING", "SUCCESS"]
    assert bench.journal.lines == ["w starts", "w ends"]


def test_children_that_have_finished_are_not_run_again(bench):
    bench.build(
        """
        parallel:
          - {skill: work, name: a, in: {label: a}}
          - {skill: work, name: b, in: {label: b, ticks: 3}}
        """
    )
    assert bench.tick(3) == ["RUNNING", "RUNNING", "SUCCESS"]
    assert bench.journal.lines.count("a starts") == 1


def test_a_second_activation_begins_afresh(bench):
    answer, lines = bench.run(
        """
        repeat:
          times: 2
          child:
            parallel: [{skill: work, in: {label: a}}, {when: true}]
        """
    )
    assert answer == "SUCCESS"
    assert lines.count("a starts") == 2


@pytest.mark.parametrize(
    ("policy", "message"),
    [
        ("succeed: 3", "succeed: expected at most 2, the number of children; got 3"),
        ("fail: 3", "fail: expected at most 2, the number of children; got 3"),
        ("succeed: [wen]", "succeed: no child is named 'wen'; did you mean 'when'?"),
    ],
)
def test_policies_are_held_against_the_children(bench, policy, message):
    faults = bench.faults(f"parallel: {{{policy}, children: [{{when: true}}, {{when: true}}]}}")
    assert any(message in fault for fault in faults), faults
