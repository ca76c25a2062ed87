"""Laws of injected faults: what they do, and what they leave as it was."""

import json

import pytest
from toy_faults import PATHS, Run

from executive.core.errors import InputError
from executive.engine.recording.messages import INTERVENTIONS_TOPIC

KINDS = ("fail", "hang", "raise", "delay 0.5")


@pytest.fixture(scope="module")
def healthy(tmp_path_factory):
    return Run(tmp_path_factory.mktemp("healthy"))


def test_a_run_without_faults_is_the_same_with_faults_that_never_happen(healthy, tmp_path):
    assert healthy.outcome == "success"
    run = Run(tmp_path, "grasp: fail@9", "look: hang@9", "key part: drop@9", "key sure: value 1@9")
    assert run.happened() == healthy.happened()
    assert [report.times for report in run.result.injected] == [0, 0, 0, 0]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", PATHS)
@pytest.mark.parametrize("number", [1, 2, 3])
def test_a_fault_never_changes_what_was_before_it(healthy, tmp_path, kind, name, number):
    run = Run(tmp_path, f"{name}: {kind}@{number}")
    (report,) = run.result.injected
    assert report.times == 1
    assert report.places == (PATHS[name],)
    first = report.first_tick
    assert run.happened(first) == healthy.happened(first)
    assert run.happened() != healthy.happened()


@pytest.mark.parametrize("what", ["stale@2", "stale@3", "drop@2", 'value "wire"@2'])
def test_a_fault_of_a_key_never_changes_what_was_before_it(healthy, tmp_path, what):
    run = Run(tmp_path, f"key part: {what}")
    first = run.result.injected[0].first_tick
    assert run.happened(first) == healthy.happened(first)


@pytest.mark.parametrize("at", [1, 2, 3])
def test_a_leaf_that_is_to_fail_gives_the_statuses_of_one_that_fails_by_its_script(tmp_path, at):
    well = "{outcome: success, ticks: 3}"
    outcomes = [well] * 3
    outcomes.insert(at - 1, "{outcome: failure, reason: injected.failure}")
    scripted = Run(tmp_path, grasps=", ".join(outcomes))
    injected = Run(tmp_path, f"grasp: fail@{at}")
    assert injected.answers() == scripted.answers()
    ends = [[(end.node, end.status) for end in tick.outcomes] for tick in injected.ticks]
    assert ends == [[(end.node, end.status) for end in tick.outcomes] for tick in scripted.ticks]


def test_every_activation_fails_without_a_number_and_from_one_on_with_a_plus(tmp_path):
    every = Run(tmp_path, "grasp: fail")
    assert every.outcome == "failure"
    assert every.result.injected[0].times == 3
    assert every.reason == f"{PATHS['grasp']}: injected.failure: by 'grasp: fail'"
    later = Run(tmp_path, "grasp: fail@2+")
    assert (later.outcome, later.result.injected[0].times) == ("failure", 3)


def test_a_leaf_that_hangs_is_never_started_and_stopped_exactly_once(tmp_path):
    run = Run(tmp_path, "grasp: hang@1")
    assert run.outcome == "success"
    assert run.halts("grasp") == 1
    assert [action.status for action in run.result.report.actions][:2] == ["halted", "success"]
    for_ever = Run(tmp_path, "place: hang")
    assert for_ever.outcome == "timeout"
    assert for_ever.halts("place") == 1
    assert "RUNNING" not in for_ever.recording.statuses(len(for_ever.recording) - 1)


def test_a_delay_is_on_the_clock_of_the_cell_and_then_the_node_starts(healthy, tmp_path):
    run = Run(tmp_path, "place: delay 1.5@2")
    assert run.outcome == "success"
    usual_s = healthy.result.report.sim_s
    assert run.result.report.sim_s == pytest.approx(usual_s + 1.5)
    assert run.halts("place") == 0


def test_what_is_raised_follows_what_the_mission_says_of_errors(tmp_path):
    ends = Run(tmp_path, "grasp: raise@2", on_error="end")
    assert ends.outcome == "error"
    assert PATHS["grasp"] in ends.reason
    assert "InjectedError: by 'grasp: raise@2'" in ends.reason
    goes_on = Run(tmp_path, "grasp: raise@2", on_error="fail")
    assert goes_on.outcome == "success"
    assert any("InjectedError" in line for line in goes_on.result.raised)
    failed = Run(tmp_path, "grasp: fail@2", on_error="fail")
    assert goes_on.answers() == failed.answers()


def test_inner_nodes_fail_with_their_reason_and_without_asking_their_children(tmp_path):
    run = Run(tmp_path, "until_held: fail")
    assert run.outcome == "failure"
    assert run.reason == "fetch/one/until_held: injected.failure: by 'until_held: fail'"
    assert not run.written("part")
    block = Run(tmp_path, "one: fail")
    assert block.reason == "fetch/one: injected.failure: by 'one: fail'"
    once = Run(tmp_path, "pick: fail@1", "place: fail@3+", "let_go: fail")
    assert "pick" not in once.reason


def test_a_glob_means_leaves_where_it_means_some(tmp_path):
    run = Run(tmp_path, "l*: fail@1")
    assert run.result.injected[0].places == (PATHS["look"],)
    block = Run(tmp_path, "pi*: fail@1").result.injected[0]
    assert block.places == ("fetch/one/until_held/pick",)


def test_chance_is_that_of_the_seed(tmp_path):
    def ticks(seed):
        run = Run(tmp_path, "grasp: fail 0.5", seed=seed)
        return run.happened(), run.result.injected[0].times

    assert ticks(1) == ticks(1)
    times = [ticks(seed)[1] for seed in range(20)]
    assert len(set(times)) > 1
    # Of about 3 to 9 activations a run, half fail: 60 runs' worth of either would be a bias.
    assert 20 < sum(times) < 100


def test_of_two_faults_for_one_activation_the_first_happens(tmp_path):
    run = Run(tmp_path, "grasp: fail@1", "grasp: hang")
    first, second = run.result.injected
    assert (first.times, run.halts("grasp")) == (1, second.times)


def test_writes_are_stale_wrong_or_lost(healthy, tmp_path):
    assert healthy.written("part") == ["bolt", "nut", "gear"]
    assert Run(tmp_path, "key part: stale@2").written("part") == ["bolt", "bolt", "gear"]
    assert Run(tmp_path, "key part: stale@2+").written("part") == ["bolt", "bolt", "bolt"]
    assert Run(tmp_path, "key part: stale").written("part") == ["bolt", "bolt", "bolt"]
    assert Run(tmp_path, "key part: drop@2").written("part") == ["bolt", "gear"]
    assert Run(tmp_path, 'key fetch:part: value "x"@3').written("part") == ["bolt", "nut", "x"]


def test_a_lost_write_leaves_what_was_there_and_the_first_leaves_nothing(tmp_path):
    assert Run(tmp_path, "key part: drop@2").outcome == "success"
    first = Run(tmp_path, "key part: drop@1")
    assert first.outcome == "error"
    assert "part" in first.reason


def test_a_number_that_is_none_is_written_as_such(tmp_path):
    run = Run(tmp_path, "key sure: value nan@1")
    assert "nan" in json.dumps(run.written("sure")[0]).lower()
    assert run.outcome == "success"


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        ("graps: fail", "no node 'graps'; did you mean 'grasp'?"),
        ("key prat: stale", "no key 'prat'; did you mean 'part'?"),
        ("key part: value 3", "key 'part' of fetch: expected str, got 3"),
        ('key sure: value "x"', "key 'sure' of fetch: expected float, got 'x'"),
        ("key part: value nan", "expected str, got nan"),
    ],
)
def test_what_means_nothing_in_a_mission_is_refused_before_it_begins(tmp_path, fault, said):
    with pytest.raises(InputError) as error:
        Run(tmp_path, fault)
    assert said in str(error.value)
    assert not (tmp_path / "run.mcap").exists()


def test_the_recording_tells_what_was_injected_where_and_when(tmp_path):
    run = Run(tmp_path, "grasp: hang@2", "key part: stale@2")
    header = run.recording.header
    assert header.faults == ("grasp: hang@2", "key part: stale@2")
    messages = [m for m in run.recording.streams() if m.topic == INTERVENTIONS_TOPIC]
    notes = [json.loads(message.data) for message in messages]
    stale, hang, *later = notes
    look, grasp = (header.nodes.index(n) for n in header.nodes if n.name in ("look", "grasp"))
    assert (stale["node"], stale["answer"]) == (look, None)
    assert stale["what"] == "injected: key part: stale@2 (fetch:part)"
    assert (hang["node"], hang["answer"], hang["by"]) == (grasp, "RUNNING", "inject")
    assert [report.first_tick for report in run.result.injected] == [hang["tick"], stale["tick"]]
    assert {note["answer"] for note in later} == {"RUNNING"}
