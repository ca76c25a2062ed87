"""`cellwright run --inject` and `cellwright campaign faults`, as a user calls them."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from toy_faults import GRASP, PATHS, write_fetch
from typer.testing import CliRunner

from executive.cli.main import app
from executive.core.errors import InputError
from executive.engine.faults.store import CampaignFolder, CampaignPlan, FaultRun
from executive.engine.recording.reader import Recording
from executive.engine.result_folders import PLAN, RESULTS

LIMIT_S = 60.0


def cellwright(*arguments):
    return CliRunner().invoke(app, [*map(str, arguments)])


def refused(*arguments):
    """Return what is said of input that cannot be used."""
    error = cellwright(*arguments).exception
    assert isinstance(error, InputError)
    return str(error)


@pytest.fixture
def mission(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_fetch(tmp_path)
    return "fetch.yaml"


def test_run_tells_what_was_injected(mission):
    Path("faults.txt").write_text("# both\nlook: fail@7\n")
    run = cellwright("run", mission, "--inject", "grasp: fail@1", "--faults", "faults.txt")
    assert run.exit_code == 0
    assert f"injected  grasp: fail@1 - {PATHS['grasp']}, first @1" in run.stdout
    assert "injected  look: fail@7 - never happened" in run.stdout
    (recording,) = Path("runs").glob("*.mcap")
    shown = cellwright("inspect", recording, "--plain")
    assert f"injected grasp: fail@1 - {PATHS['grasp']}, first @1" in shown.stdout
    assert "injected     grasp: fail@1" in cellwright("report", recording).stdout


def test_run_refuses_a_fault_before_anything_is_opened(mission):
    Path("faults.txt").write_text("look: fail\nlook: hagn\n")
    run = cellwright("run", mission, "--faults", "faults.txt")
    assert run.exit_code == 2
    assert "faults.txt: line 2: fault 'look: hagn': unknown kind" in run.output
    assert "did you mean 'hang'?" in run.output
    assert cellwright("run", mission, "--inject", "graps: fail").exit_code == 2
    assert not Path("runs").exists()


def test_a_campaign_tries_each_fault_and_goes_on_without_repeating_any(mission, tmp_path):
    options = ("campaign", "faults", mission, "--out", "camp", "--workers", "2", "--timeout", "9")
    first = cellwright(*options, "--only", "grasp|let_go", "--kinds", "fail,raise")
    assert first.exit_code == 0, first.output
    assert "without a fault: success" in first.stdout
    head, failed, raised = (" ".join(line.split()) for line in first.stdout.splitlines()[1:4])
    assert head == "fault outcome time s answered by left running reason"
    assert failed.startswith("survived grasp: fail@1 success")
    assert failed.endswith("until_held (recovered) -")
    assert raised.startswith("ended grasp: raise@1 error 0.1 - - grasp (grasp): raised at tick 1")
    assert "2 faults: 1 survived (50 %), 1 ended with a reason, 0 ended wrongly" in first.stdout
    assert "2 not reached" in first.stdout
    made = Path("camp/grasp.fail.1.mcap").stat().st_mtime_ns
    again = ("--resume", "--only", "grasp|place", "--kinds", "fail,hang", "--json")
    more = cellwright(*options, *again, "--fail-under", "50")
    assert more.exit_code == 1  # nothing ends a place that hangs but the time limit
    document = json.loads(more.stdout)
    verdicts = {run["fault"]: run["verdict"] for run in document["runs"]}
    assert verdicts == {
        f"{PATHS['grasp']}: fail@1": "survived",
        f"{PATHS['grasp']}: hang@1": "survived",
        f"{PATHS['place']}: fail@1": "survived",
        f"{PATHS['place']}: hang@1": "wrong",
    }
    assert "but the time limit" in document["runs"][-1]["wrong"]
    assert document["survived_percent"] == 75.0
    assert Path("camp/grasp.fail.1.mcap").stat().st_mtime_ns == made
    for run in document["runs"]:
        result = Recording.open(Path(run["recording"])).result
        assert [one.fault for one in result.injected] == [run["fault"]]
        assert run["left_running"] == []
    few = ("--resume", "--only", "grasp", "--kinds", "raise,hang", "--fail-under")
    assert cellwright(*options, *few, "50").exit_code == 0
    assert cellwright(*options, *few, "51").exit_code == 1
    assert "try --resume, or another --out" in refused(*options)
    assert "seed 0, not 1" in refused(*options, "--resume", "--seed", 1)
    write_fetch(tmp_path, grasps=f"{GRASP}, {GRASP}")
    assert "fetch_stubs.yaml: has changed since the campaign began" in refused(*options, *few, "50")


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--kinds", "flail"), "did you mean 'fail'?"),
        (("--kinds", ","), "--kinds: got nothing"),
        (("--resume",), "--resume: which campaign?"),
        (("--resume", "--out", "nowhere"), "no campaign to resume"),
    ],
)
def test_bad_input_is_answered(mission, options, said):
    assert said in refused("campaign", "faults", mission, *options)
    assert not Path("runs").exists()


def test_a_mission_with_faults_is_told_before_a_folder_is_made(mission):
    Path("fetch_stubs.yaml").write_text(Path("fetch_stubs.yaml").read_text().replace("let_go", "x"))
    assert "unknown skill 'let_go'" in refused("campaign", "faults", mission, "--out", "camp")
    assert not Path("camp").exists()


def test_a_campaign_that_was_killed_goes_on(mission):
    command = "from executive.cli.main import main; main()"
    words = ("campaign", "faults", mission, "--kinds", "fail", "--out", "camp")
    process = subprocess.Popen(
        [sys.executable, "-c", command, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    results, end_s = Path("camp") / RESULTS, time.monotonic() + LIMIT_S
    while not (results.exists() and "fail@1" in results.read_text().partition("let_go")[2]):
        assert time.monotonic() < end_s
        assert process.poll() is None
        time.sleep(0.05)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    done = results.read_text().count("\n")
    with results.open("a") as file:
        file.write('{"fault": "cut o')
    run = cellwright(*words, "--resume", "--json")
    assert run.exit_code == 0, run.output
    assert json.loads(run.stdout)["survived"] == 3
    assert len(CampaignFolder(Path("camp")).results()) == 4
    assert results.read_text().count("fail@1") == 4
    assert 1 <= done <= 3


def test_a_campaign_that_is_told_to_stop_says_how_to_go_on(mission):
    command = "from executive.cli.main import main; main()"
    words = ("campaign", "faults", mission, "--kinds", "fail", "--out", "camp")
    process = subprocess.Popen(
        [sys.executable, "-c", command, *words], stderr=subprocess.PIPE, text=True
    )
    plan, end_s = Path("camp") / PLAN, time.monotonic() + LIMIT_S
    while not plan.exists():
        assert time.monotonic() < end_s
        time.sleep(0.05)
    os.kill(process.pid, signal.SIGINT)
    _, said = process.communicate(timeout=LIMIT_S)
    assert process.returncode == 4
    assert "go on with --resume --out camp" in said


def test_results_that_were_cut_off_are_left_out(tmp_path):
    folder = CampaignFolder(tmp_path / "camp")
    plan = CampaignPlan(mission="m", seed=0, timeout_s=None, assignments=())
    folder.begin(plan)
    (tmp_path / "camp" / RESULTS).write_text('{"fault": "a: fail@1", "verd')
    folder.resume(plan)
    assert folder.results() == {}


def test_a_run_that_died_is_tried_again(tmp_path):
    folder = CampaignFolder(tmp_path / "camp")
    folder.begin(CampaignPlan(mission="m", seed=0, timeout_s=None, assignments=()))
    died = FaultRun(fault="a: fail@1", verdict="wrong", outcome="died")
    folder.add(died)
    assert (folder.results(), folder.finished()) == ({died.fault: died}, {})
    ended = FaultRun(fault="a: fail@1", verdict="ended", outcome="failure")
    folder.add(ended)
    assert folder.results() == folder.finished() == {died.fault: ended}
