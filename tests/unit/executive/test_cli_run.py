"""`cellwright run`: its JSON contract, its exit codes, and how it is stopped."""

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import toy_cellwright
from typer.testing import CliRunner

from executive.cli.main import app
from executive.cli.settings import apply_settings
from executive.core.errors import InputError
from executive.engine.recording.reader import Recording

KEYS = [
    *("mission", "seed", "outcome", "reason", "claim", "truth", "sim_s", "wall_s", "ticks"),
    *("actions", "recording"),
]


@pytest.fixture
def mission(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for module, name, toy in toy_cellwright.replacements():
        monkeypatch.setattr(module, name, toy)
    return toy_cellwright.write_mission(tmp_path)


def run(*arguments):
    return CliRunner().invoke(app, ["run", *map(str, arguments)])


def run_json(*arguments):
    result = run(*arguments, "--json")
    return result.exit_code, json.loads(result.stdout)


def test_json_has_exactly_the_keys_of_the_contract(mission):
    code, document = run_json(mission, "--seed", 7, "--record", "a.mcap")
    assert code == 0
    assert list(document) == KEYS
    assert document["mission"] == "toy"
    assert document["seed"] == 7
    assert document["outcome"] == "success"
    assert document["claim"] == {"untangled": True, "knotted_probability": 0.02}
    assert document["truth"] == {"untangled": True, "crossings": 0}
    assert document["ticks"] == 4
    assert document["sim_s"] == pytest.approx(0.3)
    assert document["recording"] == "a.mcap"
    (action,) = document["actions"]
    assert action == {
        "name": "toy_move",
        "start_s": 0.0,
        "duration_s": pytest.approx(0.3),
        "status": "success",
        "reason": "",
    }


def test_the_recording_holds_the_same_report_and_what_was_resolved(mission):
    _, document = run_json(mission, "--seed", 7, "--set", "steps=5", "--set", "cable.knot=none")
    recording = Recording.open(Path(document["recording"]))
    assert json.loads(recording.result.report.model_dump_json()) == document
    header = recording.header
    assert (header.mission, header.seed, header.tick_hz) == ("toy", 7, 10.0)
    assert header.inputs == {"steps": 5}
    assert header.scenario == {"cable": {"knot": "none"}, "ending": "success"}
    assert [Path(source.file).name for source in header.sources] == ["toy.yaml", "toy_cell.yaml"]
    assert header.sources[0].text == toy_cellwright.MISSION
    assert header.nodes[1].acts
    assert header.nodes[1].line == 14
    assert header.versions["python"].startswith("3.")


def test_without_a_name_the_recording_goes_to_the_runs_folder(mission):
    _, document = run_json(mission, "--seed", 3)
    assert Path(document["recording"]).match("runs/*_toy_3.mcap")


def test_the_same_seed_gives_the_same_recording(mission):
    from executive.engine.recording.fingerprint import status_fingerprint

    prints = {
        status_fingerprint(
            Recording.open(Path(run_json(mission, "--record", name)[1]["recording"]))
        )
        for name in ("a.mcap", "b.mcap")
    }
    assert len(prints) == 1


def test_a_failed_mission_exits_with_1_and_its_reason(mission):
    code, document = run_json(mission, "--set", "ending=failure")
    assert (code, document["outcome"]) == (1, "failure")
    assert document["reason"] == "toy/toy_end: toy.missed: nothing there"
    assert document["claim"] is None


def test_a_mission_out_of_time_exits_with_1(mission):
    code, document = run_json(mission, "--timeout", "0.15")
    assert (code, document["outcome"]) == (1, "timeout")
    assert "toy/toy_move" in document["reason"]


def test_a_node_that_raises_exits_with_3_and_names_node_and_recording(mission):
    code, document = run_json(mission, "--set", "ending=raise", "--record", "broken.mcap")
    assert (code, document["outcome"]) == (3, "error")
    assert "toy/toy_end (toy_end): raised at tick 3" in document["reason"]
    assert "the toy broke" in document["reason"]
    assert Recording.open(Path("broken.mcap")).tick(3).faults[0].path == "toy/toy_end"
    printed = run(mission, "--set", "ending=raise", "--record", "again.mcap").stdout
    assert "toy/toy_end" in printed
    assert "again.mcap" in printed


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--set", "stpes=3"], "did you mean 'steps'"),
        (["--set", "cabel.knot=none"], "did you mean 'cable'"),
        (["--set", "steps"], "expected key=value"),
        (["--set", "steps=many"], "steps"),
        (["--set", "steps=[1"], "not YAML"),
        (["--set", "ending=sucess"], "did you mean 'success'"),
        (["--set", "ending.deep=1"], "expected a mapping"),
    ],
)
def test_bad_settings_exit_with_2_and_say_what_was_meant(mission, arguments, message):
    code, document = run_json(mission, *arguments)
    assert (code, document["outcome"], document["recording"]) == (2, "error", None)
    assert message in document["reason"]


def test_an_unknown_mission_exits_with_2_and_the_closest_name(mission):
    code, document = run_json("toyy")
    assert code == 2
    assert "unknown mission 'toyy'" in document["reason"]


def test_a_mission_with_faults_exits_with_2_and_all_of_them(mission):
    mission.write_text(toy_cellwright.MISSION.replace("toy_move", "toy_mvoe"))
    result = run(mission)
    assert result.exit_code == 2
    assert "toy.yaml:14" in result.stderr
    assert "did you mean 'toy_move'" in result.stderr


def test_a_recording_that_cannot_be_written_exits_with_3(mission):
    Path("file").write_text("")
    code, document = run_json(mission, "--record", "file/a.mcap")
    assert code == 3
    assert "cannot write the recording" in document["reason"]


def test_people_get_a_summary_on_stdout_and_progress_on_stderr(mission):
    result = run(mission, "--record", "a.mcap")
    assert result.exit_code == 0
    assert "toy       success" in result.stdout
    assert "cellwright inspect a.mcap" in result.stdout
    assert "toy_move" in result.stderr


def test_a_truth_that_cannot_be_had_costs_nothing_else(mission, monkeypatch):
    def truth(self):
        raise OSError("no referee")

    monkeypatch.setattr(toy_cellwright.ScoredCell, "truth", truth)
    code, document = run_json(mission, "--record", "a.mcap")
    assert (code, document["outcome"]) == (0, "success")
    assert document["claim"] == {"untangled": True, "knotted_probability": 0.02}
    recording = Recording.open(Path("a.mcap"))
    assert recording.result.raised == ("truth: OSError: no referee",)
    assert "raised    truth: OSError: no referee" in run(mission).stdout


def test_the_slowest_nodes_are_named_worst_first_and_recorded(mission):
    toy = toy_cellwright.MISSION.replace("{steps: $steps}}", "{steps: $steps}, budget_s: 0.0001}")
    mission.write_text(toy)
    result = run(mission, "--record", "a.mcap")
    assert "slow      toy/toy_move: 3 times over 0.0001 s a step, at worst 0.0" in result.stdout
    recording = Recording.open(Path("a.mcap"))
    (slow,) = recording.result.slow
    assert (slow.path, slow.times, slow.budget_s) == ("toy/toy_move", 3, 0.0001)
    assert [step.node for step in recording.tick(0).slow] == [1]


def test_what_leaves_survived_is_in_the_summary(mission):
    mission.write_text(
        toy_cellwright.MISSION.replace("cell: toy_cell", "cell: toy_cell\non_error: fail")
    )
    result = run(mission, "--set", "ending=raise")
    assert result.exit_code == 1
    assert (
        "raised    toy/toy_end (toy_end): raised at tick 3: DeviceError: the toy" in result.stdout
    )


def test_a_replay_is_written_from_the_recording(mission, monkeypatch):
    written = []
    views = type(sys)("executive.app.views")
    views.write_html = lambda recording, html: written.append((recording, html))
    monkeypatch.setitem(sys.modules, "executive.app.views", views)
    run(mission, "--record", "a.mcap", "--html", "a.html")
    assert written == [(Path("a.mcap"), Path("a.html"))]


def test_a_live_view_is_told_of_the_run_and_closed(mission, monkeypatch):
    class View:
        url, calls = "http://localhost:7000", []

        def on_tick(self, tick):
            self.calls.append("tick")

        def on_streams(self, messages):
            self.calls.extend(message.topic for message in messages)

        def close(self):
            self.calls.append("close")

    views = type(sys)("executive.app.views")
    worlds = []

    def open_live_view(world):
        worlds.append(world)
        return View()

    views.open_live_view = open_live_view
    monkeypatch.setitem(sys.modules, "executive.app.views", views)
    result = run(mission, "--view")
    assert View.url in result.stderr
    assert worlds == ["toy"]
    assert View.calls.count("tick") == 4
    assert View.calls.count("/toy") == 4
    assert View.calls[-1] == "close"


def started(folder, *arguments):
    """Start the toy command line as a process of its own, in a long mission."""
    script = Path(toy_cellwright.__file__)
    command = [sys.executable, script, "run", toy_cellwright.write_mission(folder), "--json"]
    command += ["--record", folder / "a.mcap", "--set", "steps=100000", *arguments]
    return subprocess.Popen(
        list(map(str, command)), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def ticking(path, least=1):
    """Wait until a recording has ticks."""
    end_s = time.monotonic() + 30.0
    while time.monotonic() < end_s:
        if path.exists() and path.stat().st_size and len(Recording.open(path)) >= least:
            return
        time.sleep(0.05)
    raise AssertionError("no tick was recorded")


def test_one_interrupt_ends_the_process_in_order_with_4(tmp_path):
    process = started(tmp_path, "--timeout", "100000")
    ticking(tmp_path / "a.mcap")
    process.send_signal(signal.SIGINT)
    stdout, stderr = process.communicate(timeout=30)
    document = json.loads(stdout)
    assert (process.returncode, document["outcome"]) == (4, "aborted"), stderr
    assert document["reason"] == "stopped by SIGINT in toy/toy_move"
    recording = Recording.open(tmp_path / "a.mcap")
    assert recording.complete
    assert recording.tick(len(recording) - 1).halts


def test_ctrl_z_pauses_the_mission_and_lets_it_go_on(tmp_path):
    process = started(tmp_path, "--timeout", "100000")
    ticking(tmp_path / "a.mcap")
    process.send_signal(signal.SIGTSTP)
    time.sleep(1.0)
    paused = len(Recording.open(tmp_path / "a.mcap"))
    time.sleep(0.5)
    assert len(Recording.open(tmp_path / "a.mcap")) == paused
    process.send_signal(signal.SIGTSTP)
    ticking(tmp_path / "a.mcap", paused + 5)
    process.send_signal(signal.SIGINT)
    _, stderr = process.communicate(timeout=30)
    assert "paused" in stderr
    assert "by SIGTSTP (toy/toy_move: hold)" in stderr
    assert "resumed" in stderr


def test_a_second_interrupt_breaks_into_a_tick_that_hangs(tmp_path):
    process = started(tmp_path, "--set", "steps=1", "--set", "ending=hang")
    ticking(tmp_path / "a.mcap")
    for _ in range(2):
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
    stdout, stderr = process.communicate(timeout=30)
    document = json.loads(stdout)
    assert (process.returncode, document["outcome"]) == (4, "aborted"), stderr
    assert document["reason"].startswith("emergency stop by SIGINT")


def test_stdout_holds_nothing_but_the_document(tmp_path):
    process = started(tmp_path, "--set", "steps=1")
    stdout, stderr = process.communicate(timeout=30)
    assert json.loads(stdout)["outcome"] == "success"
    assert "a library that prints to stdout" in stderr


def test_settings_leave_the_mission_as_it_was():
    scenario = {"cable": {"knot": "overhand", "length_m": 3.0}}
    settings = apply_settings(["cable.knot=none", "cable.file=a.json"], ["steps"], scenario)
    assert settings.scenario == {"cable": {"knot": "none", "length_m": 3.0, "file": "a.json"}}
    assert scenario == {"cable": {"knot": "overhand", "length_m": 3.0}}


def test_values_of_settings_are_yaml():
    values = ["a=1", "b=1.5", "c=true", "d=[x, y]", "e=null", "f=two words"]
    settings = apply_settings(values, list("abcdef"), {})
    assert settings.inputs == {
        "a": 1,
        "b": 1.5,
        "c": True,
        "d": ["x", "y"],
        "e": None,
        "f": "two words",
    }


def test_a_setting_without_a_place_is_refused():
    with pytest.raises(InputError, match="unknown key 'knot'"):
        apply_settings(["knot=none"], ["steps"], {"cable": {}})


def test_an_interrupt_before_the_first_tick_is_an_abort(mission, monkeypatch):
    def interrupted(*_):
        signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(toy_cellwright.compose, "open_cell", interrupted)
    code, document = run_json(mission)
    assert (code, document["outcome"]) == (4, "aborted")


def test_an_earlier_recording_is_not_replaced_unless_that_is_asked_for(mission):
    run_json(mission, "--record", "a.mcap")
    before = Path("a.mcap").read_bytes()
    code, document = run_json(mission, "--record", "a.mcap")
    assert code == 2
    assert "is there already" in document["reason"]
    assert Path("a.mcap").read_bytes() == before
    assert run_json(mission, "--record", "a.mcap", "--overwrite")[0] == 0
    assert Path("a.mcap").read_bytes() != before


def test_an_unknown_command_is_answered_with_the_closest():
    result = CliRunner().invoke(app, ["chek"])
    assert "did you mean 'check'" in str(result.exception)
