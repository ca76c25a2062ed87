"""Mission reports: times add up, JUnit is XML, and the cause is in it."""

import dataclasses
import json
from xml.etree import ElementTree

import pytest
from toy_pasts import RandomTree, act, past

from executive.inspector.junit import junit
from executive.inspector.report import mission_report
from executive.inspector.report_text import report_markdown, report_text, summary_text


@pytest.mark.parametrize("seed", range(12))
def test_own_times_add_up_to_the_cycle_time(tmp_path, seed):
    tree = RandomTree(seed)
    report = mission_report(past(tmp_path, tree.root, tree.letters(tree.random_answers())))
    own_s = sum(line.times.own_s for line in report.nodes)
    assert own_s == pytest.approx(report.cycle_s)
    assert report.nodes[0].times.running_s == pytest.approx(report.cycle_s)
    for line in report.nodes:
        times = line.times
        assert times.started == times.succeeded + times.failed + times.halted
        assert 0.0 <= times.own_s <= times.running_s <= report.cycle_s + 1e-9


RECOVERING = f"""
retry:
  times: 3
  child:
    sequence:
      name: pick
      children:
        - selector:
            name: get
            children: [{act("grasp")}, {act("scoop")}]
        - {act("lift")}
"""


@pytest.fixture
def recovered(tmp_path):
    # Attempt 1: grasp 1.0 s, scoop 0.5 s, lift fails after 0.2 s; attempt 2: grasp 0.3 s, lift 0.
    letters = {"grasp": "R" * 10 + "F" + "RRRS", "scoop": "RRRRRS", "lift": "RRFS"}
    return mission_report(past(tmp_path, RECOVERING, letters))


def test_recovery_is_fallbacks_and_later_attempts_counted_once(recovered):
    assert recovered.cycle_s == pytest.approx(2.1)
    assert recovered.recovery.fallbacks_s == pytest.approx(0.5)
    # From the failure at 1.7 s to the end: the tick between the attempts, and the second one.
    assert recovered.recovery.retries_s == pytest.approx(0.4)
    assert recovered.recovery.total_s == pytest.approx(0.9)


def test_recovery_counts_a_fallback_of_a_later_attempt_once(tmp_path):
    letters = {"grasp": "F", "scoop": "RRRSRRS", "lift": "FS"}
    report = mission_report(past(tmp_path, RECOVERING, letters))
    assert report.recovery.total_s == pytest.approx(report.cycle_s)
    assert report.recovery.fallbacks_s + report.recovery.retries_s > report.cycle_s


def test_attempts_and_failures_are_counted(recovered):
    (retry,) = recovered.retries
    assert (retry.attempts, retry.most, retry.allowed) == (2, 2, 3)
    assert {(f.name, f.code): f.count for f in recovered.failures} == {
        ("grasp", "act.failed"): 1,
        ("lift", "act.failed"): 1,
    }


@pytest.fixture
def reports(tmp_path):
    root = f"{{sequence: [{act('one')}, {act('two')}]}}"
    return [
        mission_report(past(tmp_path, root, {"one": "RS", "two": said}, name=f"run{n}", seed=n))
        for n, said in enumerate(["RS", "RF", "R"])
    ]


def test_junit_is_xml_with_the_chain_of_every_run_that_failed(reports):
    suites = ElementTree.fromstring(junit(reports))
    cases = suites.findall("testsuite/testcase")
    assert suites.get("tests") == "3"
    assert suites.get("failures") == "2"
    assert [case.find("failure") is None for case in cases] == [True, False, False]
    failed = cases[1].find("failure")
    assert failed.text == "\n".join(reports[1].chain)
    assert "two: failed: act.failed: two was told to  [t.yaml:" in failed.text
    assert cases[2].find("failure").get("type") == "timeout"
    total_s = sum(float(case.get("time")) for case in cases)
    assert float(suites.get("time")) == pytest.approx(total_s, abs=0.01)


def test_junit_leaves_out_what_xml_cannot_hold(reports):
    odd = dataclasses.replace(reports[1], reason="beep \x07 <&> \ud83d", chain=("a\x00b <c>",))
    assert ElementTree.fromstring(junit([odd]).encode("utf-8")).find(".//failure").text == "ab <c>"


def test_text_and_markdown_begin_with_how_it_ended(reports):
    assert report_text(reports[1]).startswith("t ended in failure: t/two: act.failed")
    assert report_markdown(reports[1]).startswith("# t, seed 1: failure\n")


def test_a_summary_counts_outcomes(reports):
    text = summary_text(reports)
    assert text.startswith("1 of 3 runs succeeded (1 success, 1 failure, 1 timeout)")
    assert "1 x two act.failed" in text


def test_reports_are_plain_data(reports):
    assert json.loads(json.dumps(dataclasses.asdict(reports[0])))["outcome"] == "success"
