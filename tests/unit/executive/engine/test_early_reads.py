"""Reads of keys that nothing can have written yet."""

import pytest

FIND = "{skill: find, out: {distance: $d}}"
USE = "{when: d > 1}"
EARLY = "has no value yet"


@pytest.mark.parametrize(
    "root",
    [
        f"sequence: [{FIND}, {USE}]",
        f"sequence: [{{selector: [{FIND}, {{when: true}}]}}, {USE}]",
        f"selector: [{{sequence: [{FIND}, {{when: false}}]}}, {USE}]",
        f"parallel: [{USE}, {FIND}]",
        f"sequence: [{{inverter: {{child: {{inverter: {{child: {FIND}}}}}}}}}, {USE}]",
        f"sequence: [{{force_success: {{child: {FIND}}}}}, {USE}]",
        "sequence: [{set: {d: 1, e: d + 1}}, {when: e > 1}]",
        "retry: {times: 2, child: {selector: "
        f"[{{sequence: [{{when: 1 > 2}}, {USE}]}}, {FIND}]}}}}",
        f"sequence: [{{when: 'not written(d)'}}, {FIND}]",
        "for_each: {item: $d, in: [1.5], child: {when: d > 1}}",
        f"repeat: {{times: 2, child: {{sequence: [{{skill: weigh, in: {{part: {{mass_kg: 1, "
        f"colour: red}}, factor: $d}}}}, {FIND}]}}}}",
        "sequence: [{skill: find, on_success: {d: 1}}, {when: d > 0}]",
        "{skill: find, out: {distance: $d}, on_success: {far: d > 1}}",
    ],
)
def test_reads_that_may_find_a_value_pass(bench, root):
    assert bench.faults(root) == []


@pytest.mark.parametrize(
    "root",
    [
        f"sequence: [{USE}, {FIND}]",
        f"selector: [{FIND}, {USE}]",
        f"sequence: [{{selector: [{USE}, {{when: true}}]}}, {FIND}]",
        f"retry: {{times: 2, child: {{sequence: [{USE}, {FIND}]}}}}",
        "repeat: {times: 2, child: {sequence: "
        f"[{{sequence: [{{when: true}}, {USE}]}}, {FIND}]}}}}",
        f"sequence: [{{inverter: {{child: {FIND}}}}}, {USE}]",
        "{skill: find, out: {distance: $d}, if: d > 1}",
        "for_each: {item: $i, in: $i, child: {when: true}}",
        "sequence: [{set: {e: d + 1, d: 1}}]",
        f"reactive_sequence: [{USE}, {FIND}]",
    ],
)
def test_reads_that_can_find_no_value_are_faults(bench, root):
    found = bench.faults(root)
    assert found, root
    assert all(EARLY in fault or "may" in fault for fault in found), found


def test_fault_names_who_writes_the_key(bench):
    assert bench.faults(f"sequence: [{USE}, {FIND}]") == [
        "t/when: when: $d has no value yet; t/find writes it later"
    ]


def test_input_with_a_default_may_be_wired_to_a_key_without_a_value(bench):
    tree = bench.build(
        """
        repeat:
          times: 2
          child:
            sequence:
              - {skill: weigh, in: {part: {mass_kg: 1, colour: red}, factor: $d}, out: {mass: $m}}
              - {skill: find, out: {distance: $d}}
        """
    )
    bench.tick(2)
    written = [write.value for write in tree.blackboard.drain_writes() if write.key == "t:m"]
    assert written == [1.0, 2.0]
