"""Two nodes can never command one arm: not by the tree, and not while it runs."""

import pytest

from executive.core.errors import ClaimError
from executive.engine.nodes.claims import Claims

GRABS = """
    parallel:
      children:
        - sequence: [{skill: grab, name: left, in: {label: a}}, {skill: work, in: {label: b}}]
        - {skill: %s, name: right, in: {label: c}}
"""


def test_a_parallel_whose_children_claim_the_same_is_refused_with_both_places(bench):
    (fault,) = bench.faults(GRABS % "grab")
    assert fault.startswith("t/right: claims arm, and so does t/sequence/left (")
    assert "t.yaml:7), which runs at the same time in t; try a sequence" in fault
    assert bench.faults(GRABS % "work") == []


@pytest.mark.parametrize("kind", ["sequence", "selector", "reactive_sequence", "reactive_selector"])
def test_children_that_run_one_after_the_other_may_claim_the_same(bench, kind):
    assert bench.faults((GRABS % "grab").replace("parallel", kind)) == []


def test_claims_inside_subtrees_are_found(bench):
    bench.write(
        "inner",
        """
        format: 1
        tree: inner
        root: {sequence: [{skill: grab, name: deep, in: {label: x}}]}
        """,
    )
    bench.write(
        "outer",
        """
        format: 1
        tree: outer
        root: {sequence: [{subtree: inner, name: use}]}
        """,
    )
    (fault,) = bench.faults(
        """
        parallel:
          - {skill: grab, in: {label: a}}
          - {force_success: {child: {subtree: outer, name: far}}}
        """
    )
    assert fault.startswith("t/force_success/far: t/force_success/far/")
    assert "claims arm, and so does t/grab" in fault


def test_a_claim_ends_with_its_node(bench):
    status, lines = bench.run(
        """
        sequence:
          - {skill: grab, name: one, in: {label: a, ticks: 2}}
          - {timeout: {seconds: 0.15, name: short, child: {skill: grab, in: {label: b, ticks: 9}}}}
        """
    )
    assert status == "FAILURE"
    assert lines == ["a starts", "a ends", "b starts", "b stops"]
    claims = bench.tree.supervision.claims
    assert claims.take("anyone", {"arm"})


def test_a_newcomer_waits_for_the_tick_in_which_the_holder_is_halted(bench):
    status, lines = bench.run(
        """
        reactive_selector:
          - sequence:
              - {when: written(go)}
              - {skill: grab, name: first, in: {label: urgent}}
          - reactive_sequence:
              - {set: {count: "(count if written(count) else 0) + 1"}}
              - force_success: {child: {when: count < 3, on_failure: {go: true}}}
              - {skill: grab, name: second, in: {label: usual, ticks: 99}}
        """,
    )
    assert status == "SUCCESS"
    assert lines == ["usual starts", "usual stops", "urgent starts", "urgent ends"]


def test_a_claim_that_is_held_by_a_node_that_goes_on_is_an_error_that_names_it():
    claims = Claims()
    claims.note_parallel("t/both")
    assert claims.take("t/both/one/grab", {"arm"})
    with pytest.raises(ClaimError, match="arm is held by t/both/one/grab, which goes on"):
        claims.take("t/both/other/grab", {"arm", "camera"})
    assert claims.take("t/both/third", {"camera"})
    claims.release("t/both/one/grab")
    assert claims.take("t/both/other/grab", {"arm"})


def test_a_newcomer_waits_for_one_tick_and_no_more():
    claims = Claims()
    claims.take("t/a", {"arm"})
    assert not claims.take("t/b", {"arm"})
    with pytest.raises(ClaimError, match="arm is held by t/a"):
        claims.take("t/b", {"arm"})
