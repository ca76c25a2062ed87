"""Sequences and selectors, with and without memory."""

import pytest

STARTS = [
    ("sequence", 0, ["a", "b", "c"], "SUCCESS"),
    ("sequence", 9, ["a", "b"], "FAILURE"),
    ("selector", 0, ["a"], "SUCCESS"),
    ("selector", 9, ["a", "b", "c"], "SUCCESS"),
]


def started(lines):
    return [line.removesuffix(" starts") for line in lines if line.endswith("starts")]


@pytest.mark.parametrize(("kind", "fails", "order", "status"), STARTS)
def test_children_run_in_order_until_one_decides(bench, kind, fails, order, status):
    failing = ("a", "b") if kind == "selector" else ("b",)
    counts = {label: fails if label in failing else 0 for label in "abc"}
    children = [
        f"{{skill: work, name: {label}, in: {{label: {label}, fails: {count}}}}}"
        for label, count in counts.items()
    ]
    answer, lines = bench.run(f"{kind}: [{', '.join(children)}]")
    assert (answer, started(lines)) == (status, order)


def test_sequence_goes_on_where_it_was(bench):
    bench.build(
        """
        sequence:
          - {skill: work, name: a, in: {label: a}}
          - {skill: work, name: b, in: {label: b, ticks: 3}}
        """
    )
    assert bench.tick(3) == ["RUNNING", "RUNNING", "SUCCESS"]
    assert started(bench.journal.lines) == ["a", "b"]


def test_reactive_sequence_begins_with_the_first_in_every_tick(bench):
    bench.build(
        """
        reactive_sequence:
          - {skill: work, name: a, in: {label: a}}
          - {skill: work, name: b, in: {label: b, ticks: 3}}
        """
    )
    assert bench.tick(3) == ["RUNNING", "RUNNING", "SUCCESS"]
    assert started(bench.journal.lines) == ["a", "b", "a", "a"]


def test_reactive_sequence_halts_what_a_condition_no_longer_allows(bench):
    tree = bench.build(
        """
        reactive_sequence:
          - {when: go}
          - {skill: work, in: {label: b, ticks: 5}}
        """,
        "in: {go: {type: bool}}",
        go=True,
    )
    bench.tick()
    tree.scope.write("go", False, "test")
    assert bench.tick() == ["FAILURE"]
    assert bench.journal.lines == ["b starts", "b stops"]


def test_reactive_selector_lets_the_first_take_over(bench):
    tree = bench.build(
        """
        reactive_selector:
          - {when: alarm}
          - {skill: work, in: {label: b, ticks: 5}}
        """,
        "in: {alarm: {type: bool, default: false}}",
    )
    assert bench.tick(2) == ["RUNNING", "RUNNING"]
    tree.scope.write("alarm", True, "test")
    assert bench.tick() == ["SUCCESS"]
    assert bench.journal.lines == ["b starts", "b stops"]


def test_selector_does_not_look_back(bench):
    tree = bench.build(
        """
        selector:
          - {when: alarm}
          - {skill: work, in: {label: b, ticks: 3}}
        """,
        "in: {alarm: {type: bool, default: false}}",
    )
    bench.tick()
    tree.scope.write("alarm", True, "test")
    assert bench.tick(2) == ["RUNNING", "SUCCESS"]
    assert bench.journal.lines == ["b starts", "b ends"]
