"""`cellwright run --break` pauses a mission; `cellwright attach` steers it from elsewhere."""

import json
import subprocess
import sys
import time
from pathlib import Path

import pytest
import toy_cellwright
from typer.testing import CliRunner

from executive.cli.main import app
from executive.engine.recording.messages import INTERVENTIONS_TOPIC, PAUSES_TOPIC
from executive.engine.recording.reader import Recording

RECORDING = Path("a.mcap")
LIMIT_S = 20.0


def cellwright(*arguments):
    return CliRunner().invoke(app, [*map(str, arguments)])


@pytest.fixture
def start(tmp_path, monkeypatch):
    """Run a mission in a process of its own; its exit code and output come from `join`."""
    monkeypatch.chdir(tmp_path)
    mission = toy_cellwright.write_mission(tmp_path)
    running = []

    def started(*options):
        command = [sys.executable, toy_cellwright.__file__, "run", str(mission)]
        command += ["--record", str(RECORDING), "--json", *options]
        process = subprocess.Popen(command, stdout=-1, stderr=-1, text=True)
        running.append(process)

        def join():
            output, errors = process.communicate(timeout=LIMIT_S)
            return process.returncode, output + errors

        return join

    yield started
    for process in running:
        process.kill()
        process.communicate()


def attach(*lines, wait=True):
    """Attach as soon as the mission listens and, where that is wanted, is paused."""
    end_s = time.monotonic() + LIMIT_S
    while time.monotonic() < end_s:
        state = cellwright("attach", RECORDING, "--do", "state", "--json")
        if state.exit_code == 0 and (not wait or json.loads(state.stdout)["paused"]):
            break
        time.sleep(0.02)
    commands = [word for line in lines for word in ("--do", line)]
    return cellwright("attach", RECORDING, *commands)


def test_a_mission_pauses_at_a_breakpoint_and_goes_on(start):
    join = start("--break", "toy_end")
    state = attach("state")
    assert "before toy/toy_end" in state.stdout
    assert attach("resume", wait=False).exit_code == 0
    assert join()[0] == 0
    topics = {message.topic for message in Recording.open(RECORDING).streams()}
    assert PAUSES_TOPIC in topics


def test_a_mission_is_stepped_and_its_outcome_forced(start):
    join = start("--paused")
    stepped = attach("step", "step")
    assert "paused tick 1" in stepped.stdout
    forced = attach("force toy_end=failure once", "resume")
    assert "forced  toy/toy_end = failure" in forced.stdout
    assert join()[0] == 1
    recording = Recording.open(RECORDING)
    assert recording.result.report.reason.startswith("toy/toy_end: debug.forced")
    told = [m.data for m in recording.streams() if m.topic == INTERVENTIONS_TOPIC]
    assert b"force failure once" in told[0]


def test_breakpoints_come_from_a_file_too(start, tmp_path):
    (tmp_path / "stops.txt").write_text("# where it went wrong\ntoy_end   # the last one\n")
    join = start("--breaks", "stops.txt")
    assert "toy_end" in attach("state").stdout
    attach("stop")
    assert join()[0] == 4


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--break", "toy_ende"), "did you mean 'toy_end'"),
        (("--break", "on failur"), "did you mean 'failure'"),
    ],
)
def test_bad_breakpoints_are_told_before_anything_moves(start, options, message):
    code, result = start(*options)()
    assert code == 2
    assert message in result


def test_a_mission_that_does_not_run_cannot_be_attached(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path(RECORDING).touch()
    result = cellwright("attach", RECORDING, "--do", "state")
    assert result.exception is not None
    assert "no running mission" in str(result.exception)


@pytest.mark.parametrize("line", ["paus", "force toy_end", "unbreak one", "pause now"])
def test_bad_lines_are_answered(line, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path(RECORDING).touch()
    result = cellwright("attach", RECORDING, "--do", line)
    assert any(word in str(result.exception) for word in ("did you mean", "expected", "nothing"))


def test_help_lists_the_commands_without_a_running_mission(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path(RECORDING).touch()
    result = cellwright("attach", RECORDING, "--do", "help")
    assert result.exit_code == 0
    assert "emergency_stop" in result.stdout
