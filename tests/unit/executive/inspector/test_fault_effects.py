"""Who answered for an injected fault, and what it left running, from the recording alone."""

import pytest
from toy_faults import PATHS, Run

from executive.engine.faults.grammar import Kind, parse_injection
from executive.engine.faults.variants import Wanted, parse_kinds, variants
from executive.inspector.fault_effects import effect_of, left_running, seen_in
from executive.inspector.past import PastRun
from executive.inspector.report import mission_report
from executive.inspector.report_text import report_text


def past(folder, *faults, **options):
    run = Run(folder, *faults, **options)
    return PastRun(run.recording)


@pytest.mark.parametrize(
    ("fault", "by", "answer"),
    [
        ("grasp: fail@1", "until_held", "recovered"),
        ("grasp: hang@1", "until_held", "recovered"),
        ("place: fail@2", "put_down", "recovered"),
        ("grasp: fail", "", ""),
        ("look: fail@2+", "", ""),
        ("place: hang@2", "", ""),
        ("key part: stale@2", "", ""),
    ],
)
def test_who_answered_for_it(tmp_path, fault, by, answer):
    effect = effect_of(past(tmp_path, fault), parse_injection(fault).kind)
    assert (effect.happened, effect.answered_by, effect.answer) == (True, by, answer)
    assert effect.to_the_end is (fault == "place: hang@2")
    assert effect.left_running == ()


def test_who_still_tries_when_the_time_is_over(tmp_path):
    run = past(tmp_path, "let_go: hang", "place: fail@2")
    effect = effect_of(run, Kind.HANG)
    assert effect.to_the_end
    again = past(tmp_path, "place: fail@2", "let_go: hang")
    effect = effect_of(again, Kind.FAIL)
    assert (effect.answered_by, effect.answer) == ("put_down", "still trying")


def test_a_raise_that_fails_its_leaf_is_answered_for_like_a_failure(tmp_path):
    effect = effect_of(past(tmp_path, "grasp: raise@1", on_error="fail"), Kind.RAISE)
    assert (effect.answered_by, effect.answer) == ("until_held", "recovered")


def test_a_fault_that_never_happened_led_to_nothing(tmp_path):
    effect = effect_of(past(tmp_path, "grasp: fail@9"), Kind.FAIL)
    assert not effect.happened


def test_what_runs_when_a_recording_was_cut_off_is_told(tmp_path):
    run = past(tmp_path, "place: hang@1")
    run.recording._raw[-1:] = []  # the end that a kill takes away
    assert left_running(PastRun(run.recording).index) == (PATHS["place"],)


def test_variants_are_all_single_faults_that_the_run_can_reach(tmp_path):
    seen = seen_in(past(tmp_path).index)
    assert [seen.skills[path] for path in PATHS.values()] == [3, 3, 3]
    assert seen.keys == {"fetch:part": 3, "fetch:sure": 3}
    found = variants(seen, Wanted(parse_kinds("fail,stale"), at=3))
    reached = {one.fault for one in found if one.reached}
    assert reached == {
        *(f"{path}: fail@3" for path in PATHS.values()),
        "key fetch:part: stale@3",
        "key fetch:sure: stale@3",
    }
    assert {one.fault for one in found} - reached == {"fetch/one/put_down/let_go: fail@3"}
    for one in found:
        assert parse_injection(one.fault).kind is one.kind
    some = variants(seen, Wanted(parse_kinds("fail,stale"), only="gra* | part"))
    assert [one.fault for one in some] == [
        f"{PATHS['grasp']}: fail@1",
        "key fetch:part: stale@2",
    ]


def test_reports_tell_of_faults(tmp_path):
    text = report_text(mission_report(past(tmp_path, "grasp: fail@1", "look: fail@9")))
    assert f"injected     grasp: fail@1 - {PATHS['grasp']}, first @1" in text
    assert "injected     look: fail@9 - never happened" in text
