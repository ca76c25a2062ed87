"""Keys of subtrees from one activation to the next."""

import pytest

COUNTER = """
format: 1
tree: counter
out: {total: {type: int}}
{keep}
root:
  sequence:
    - {set: {n: n + 1}}
    - {set: {total: n}}
"""
STALE = """
format: 1
tree: stale
in: {first: {type: bool}}
out: {seen: {type: bool}}
root:
  sequence:
    - {set: {seen: written(part)}}
    - force_success:
        child: {sequence: [{when: first}, {skill: find, out: {part: $part}}]}
"""


def count(bench, root, ticks):
    bench.write("counter", COUNTER.replace("{keep}", "keep: {n: 0}"))
    tree = bench.build(root, "out: {c: {type: int}}")
    bench.tick(ticks)
    return tree.outputs()["c"]


def test_kept_keys_of_a_subtree_outlive_its_activations(bench):
    root = "repeat: {times: 3, child: {subtree: counter, out: {total: $c}}}"
    assert count(bench, root, 3) == 3


def test_every_use_of_a_subtree_keeps_its_own(bench):
    root = "sequence: [{subtree: counter, name: a}, {subtree: counter, name: b, out: {total: $c}}]"
    assert count(bench, root, 1) == 1


def test_keys_of_a_subtree_are_forgotten_when_it_starts_anew(bench):
    bench.write("stale", STALE)
    tree = bench.build(
        """
        sequence:
          - {subtree: stale, name: one, in: {first: true}, out: {seen: $a}}
          - repeat:
              times: 2
              child: {subtree: stale, in: {first: true}, out: {seen: $b}}
        """
    )
    bench.tick(2)
    assert (tree.scope["a"], tree.scope["b"]) == (False, False)
    # What the last activation has written can still be looked at.
    assert "t/repeat/stale:part" in tree.blackboard


def test_forgetting_is_recorded_as_a_write_of_the_subtree(bench):
    bench.write("stale", STALE)
    tree = bench.build("repeat: {times: 2, child: {subtree: stale, in: {first: true}}}")
    bench.tick(1)
    tree.blackboard.drain_writes()
    bench.tick(1)
    first = tree.blackboard.drain_writes()[0]
    assert (first.key, first.writer) == ("t/stale:part", "t/stale")


def test_a_subtree_that_runs_keeps_its_keys(bench):
    bench.write_root(
        "sequence: [{set: {n: 3}}, {skill: work, in: {label: a, ticks: 3}}, {when: n > 2}]",
        name="slow",
    )
    bench.build("sequence: [{subtree: slow}]")
    assert bench.tick(3) == ["RUNNING", "RUNNING", "SUCCESS"]


def test_outputs_keep_what_an_earlier_activation_has_written(bench):
    bench.write_root(
        "selector: [{skill: find, out: {part: $part}}, {when: true}]",
        "out: {part: {type: Part}}",
        name="look",
    )
    tree = bench.build("repeat: {times: 2, child: {subtree: look, out: {part: $p}}}")
    bench.tick(2)
    assert tree.scope["p"].mass_kg == 0.5


def test_parallels_and_choices_as_roots_start_anew_too(bench):
    for kind in ("parallel", "if_then_else"):
        bench.write_root(
            f"{kind}: [{{set: {{seen: written(part)}}}}, {{skill: find, out: {{part: $part}}}}]",
            "out: {seen: {type: bool}}",
            name="look",
        )
        tree = bench.build("repeat: {times: 2, child: {subtree: look, out: {seen: $s}}}")
        bench.tick(2)
        assert tree.scope["s"] is False


def test_a_child_that_is_answered_for_is_no_new_activation(bench):
    bench.write_root(
        "running_is_success: {child: {sequence: "
        "[{set: {n: 3}}, {wait: 0.25}, {skill: work, in: {label: $n}}]}}".replace("$n", "a"),
        name="slow",
    )
    tree = bench.build("repeat: {times: forever, child: {subtree: slow}}")
    bench.tick(2)
    assert "t/slow:n" in tree.blackboard


def test_keys_of_a_subtree_at_the_root_are_not_those_of_the_tree(bench):
    bench.write_root("sequence: [{set: {n: 1}}, {set: {m: n + 1}}]", "out: {m: {type: int}}", "u")
    tree = bench.build("{subtree: u, out: {m: $n}}", "out: {n: {type: int}}")
    assert bench.tick() == ["SUCCESS"]
    assert tree.outputs() == {"n": 2}
    assert tree.blackboard.read("t.u:n") == 1


@pytest.mark.parametrize(
    ("keep", "fault"),
    [
        ("{x: 1}", "keep: 'x' is a port of the tree, which has its value from outside"),
        ("{n: $x}", "keep: 'n' needs a first value that is written out; got '$x'"),
        ("{n: 0}", None),
        ("{n: low}", "expected int, but $n is str | int"),
        ("{N: 0}", "expected a name of lower-case letters"),
    ],
)
def test_faults_of_kept_keys(bench, keep, fault):
    found = bench.faults(
        "sequence: [{retry: {times: $n + 1, child: {when: true}}}, {set: {n: 2}}, "
        "{retry: {times: $n, child: {when: true}}}]",
        f"keep: {keep}\nin: {{x: {{type: int}}}}",
    )
    assert found == [] if fault is None else any(fault in one for one in found), found
