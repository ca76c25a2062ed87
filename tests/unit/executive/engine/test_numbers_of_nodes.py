"""Numbers of nodes that are expressions: how long, how often, how likely."""

import pytest

from executive.core.errors import InputError


def starts(bench):
    return bench.journal.lines.count("a starts")


def test_times_may_be_an_expression(bench):
    root = "retry: {times: $n + 1, child: {skill: work, in: {label: a, fails: 9}}}"
    assert bench.run(root, "in: {n: {type: int}}", n=2)[0] == "FAILURE"
    assert starts(bench) == 3


def test_numbers_are_worked_out_each_time_the_node_starts(bench):
    tree = bench.build(
        """
        for_each:
          item: $n
          in: [1, 3]
          child: {repeat: {times: $n, child: {skill: work, in: {label: a}}}}
        """
    )
    bench.tick(4)
    assert tree.root.status.value == "SUCCESS"
    assert starts(bench) == 4


def test_forever_has_no_end(bench):
    bench.build("retry: {times: forever, child: {when: false}}")
    assert set(bench.tick(50)) == {"RUNNING"}
    bench.build("repeat: {times: forever, child: {when: true}}")
    assert set(bench.tick(50)) == {"RUNNING"}
    assert bench.run("repeat: {times: forever, child: {when: false}}")[0] == "FAILURE"


def test_seconds_may_be_an_expression(bench):
    root = "timeout: {seconds: $limit_s / 2, child: {skill: work, in: {label: a, ticks: 9}}}"
    bench.build(root, "in: {limit_s: {type: float, unit: s}}", limit_s=0.5)
    assert bench.tick(4) == ["RUNNING", "RUNNING", "RUNNING", "FAILURE"]


def test_pauses_grow_by_the_backoff(bench):
    bench.build(
        "retry: {times: 4, delay_s: 0.09, backoff: 3, "
        "child: {skill: work, in: {label: a, fails: 9}}}"
    )
    counts = []
    for _ in range(14):
        bench.tick()
        counts.append(starts(bench))
    # Pauses of 0.09, 0.27 and 0.81 s.
    assert counts == [1, 2, 2, 2, 3, 3, 3, 3, 3, 3, 3, 3, 3, 4]
    assert bench.tree.root.status.value == "FAILURE"


@pytest.mark.parametrize(("code", "attempts"), [("door.gone", 1), ("door.stuck", 4)])
def test_a_retry_gives_up_on_reasons_that_no_attempt_mends(bench, code, attempts):
    """A failure that a selector has answered for is none, though its reason is the same."""
    bench.build(
        f"""
        retry:
          times: 4
          gives_up_on: [door.gone]
          child:
            sequence:
              children:
                - selector:
                    children: [{{fail: door.gone}}, {{skill: work, in: {{label: a}}}}]
                - {{fail: {code}}}
        """
    )
    assert bench.tick(attempts) == ["RUNNING"] * (attempts - 1) + ["FAILURE"]
    assert starts(bench) == attempts


def test_repeat_pauses_between_rounds(bench):
    bench.build("repeat: {times: 2, delay_s: 0.25, child: {skill: work, in: {label: a}}}")
    assert bench.tick(4) == ["RUNNING", "RUNNING", "RUNNING", "SUCCESS"]
    assert starts(bench) == 2


@pytest.mark.parametrize(
    ("root", "fault"),
    [
        (
            "timeout: {seconds: $x, child: {when: true}}",
            "t: seconds: nothing in this tree writes 'x'",
        ),
        ("timeout: {seconds: $1 - 2, child: {when: true}}", "seconds: expected a number above 0"),
        ("timeout: {seconds: $word, child: {when: true}}", "expected float, but $word is str"),
        (
            "timeout: {seconds: $mm, child: {when: true}}",
            "expected the unit s, but $mm is in mm",
        ),
        ("retry: {times: $1.5, child: {when: true}}", "times: expected an integer, 1 or more"),
        ("retry: {times: $mm, child: {when: true}}", "expected int, but $mm is float"),
        ("retry: {times: $size(, child: {when: true}}", "times: 'size(' is not an expression"),
        ("wait: -1", "wait: expected at least 0; got -1"),
        ("chance: $2", "chance: expected a number from 0 to 1, got 2"),
        ("chance: 1.5", "chance: expected at most 1; got 1.5"),
    ],
)
def test_numbers_are_checked_before_the_first_tick(bench, root, fault):
    ports = "in: {word: {type: str}, mm: {type: float, unit: mm}}"
    found = bench.faults(root, ports)
    assert any(fault in one for one in found), found


@pytest.mark.parametrize(
    ("root", "message"),
    [
        ("timeout: {seconds: $x, child: {when: true}}", "seconds: expected a number above 0"),
        ("retry: {times: $n, child: {when: true}}", "times: expected an integer, 1 or more, got 0"),
        ("wait: $x", "wait: expected a number, 0 or more, got -1.0"),
        ("chance: $x", "chance: expected a number from 0 to 1, got -1.0"),
    ],
)
def test_numbers_out_of_their_limits_are_errors_that_name_the_key(bench, root, message):
    bench.build(root, "in: {x: {type: float}, n: {type: int}}", x=-1.0, n=0)
    with pytest.raises(InputError) as failed:
        bench.tick()
    assert message in str(failed.value)
