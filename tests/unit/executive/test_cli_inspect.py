"""`cellwright inspect` where there is no terminal: it prints and returns."""

import json

import pytest
from py_trees.common import Status
from toy_runs import Leaf, busy_tree, record
from typer.testing import CliRunner

from executive.cli import main
from executive.core.outcome import failure


def inspect(*arguments):
    return CliRunner().invoke(main.app, ["inspect", *map(str, arguments)])


@pytest.fixture
def run_file(tmp_path):
    return record(tmp_path / "a.mcap", busy_tree())[0].path


def test_the_last_tick_is_shown_when_none_is_asked_for(tmp_path):
    leaf = Leaf("work", Status.RUNNING, failure("work.lost", "no light"))
    path = record(tmp_path / "a.mcap", leaf)[0].path
    result = inspect(path)
    assert result.exit_code == 0
    assert "tick 1 of 0-1" in result.stdout
    assert "work.lost: no light" in result.stdout


def test_a_run_that_was_stopped_is_shown_as_it_was_before(tmp_path):
    path = record(tmp_path / "a.mcap", Leaf("work", Status.RUNNING), timeout_s=0.3)[0].path
    assert "▶ work" in inspect(path, "--plain").stdout
    assert "what the runner stopped" in inspect(path, "--tick", "-1").stdout


def test_changes_can_be_read_by_programs(run_file):
    changes = json.loads(inspect(run_file, "--changes", "--node", "guard", "--json").stdout)
    assert {change["path"] for change in changes} == {"mission/wait/guard"}
    assert changes[0]["old"] == "INVALID"
    printed = inspect(run_file, "--changes", "--node", "guard").stdout.splitlines()
    assert len(printed) == len(changes)


def test_a_tick_can_be_read_by_programs(run_file):
    document = json.loads(inspect(run_file, "--tick", "300", "--json").stdout)
    assert document["tick"] == 300
    assert len(document["nodes"]) == 5


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--tick", "99999"], "no such tick"),
        (["--node", "gaurd"], "did you mean 'guard'"),
    ],
)
def test_bad_questions_say_what_there_is(run_file, arguments, message, monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["cellwright", "inspect", str(run_file), *arguments])
    with pytest.raises(SystemExit) as end:
        main.main()
    assert end.value.code == 2
    assert message in capsys.readouterr().err


def test_a_file_that_is_no_recording_is_bad_input(tmp_path, monkeypatch, capsys):
    (tmp_path / "a.mcap").write_bytes(b"nothing")
    monkeypatch.setattr("sys.argv", ["cellwright", "inspect", str(tmp_path / "a.mcap")])
    with pytest.raises(SystemExit) as end:
        main.main()
    assert end.value.code == 2
    assert "not a readable recording" in capsys.readouterr().err
