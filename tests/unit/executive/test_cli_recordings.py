"""Recordings have short names, which all commands understand."""

import os

import pytest
from py_trees.common import Status
from toy_runs import Leaf, record
from typer.testing import CliRunner

from executive.cli import main
from executive.cli.recordings import recording_path
from executive.core.errors import InputError
from executive.engine.recording.parts import part_path
from executive.engine.running.remote import CommandServer


@pytest.fixture
def runs(tmp_path, monkeypatch):
    """A folder of runs that the test stands beside: `old`, then `new`."""
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "runs"
    folder.mkdir()
    for age_s, name in ((200, "old"), (100, "new")):
        path = record(folder / f"{name}.mcap", Leaf("work", Status.SUCCESS), result=False)[0].path
        aged(path, age_s)
    return folder


def aged(path, age_s):
    """Let a file have been written some time ago."""
    written_s = path.stat().st_ctime - age_s
    os.utime(path, (written_s, written_s))


def test_last_is_the_recording_that_was_written_to_last(runs):
    assert recording_path("last").name == "new.mcap"
    aged(runs / "old.mcap", 10)
    assert recording_path("last").name == "old.mcap"


def test_a_recording_of_several_parts_is_one(runs):
    second = part_path(runs / "old.mcap", 2)
    second.write_bytes((runs / "old.mcap").read_bytes())
    assert recording_path("last").name == "old.mcap"


@pytest.mark.parametrize("name", ["runs/old.mcap", "old.mcap", "old"])
def test_a_recording_is_named_by_its_file_or_within_the_folder(runs, name):
    assert recording_path(name).resolve() == runs / "old.mcap"


def test_live_is_the_one_whose_mission_answers(runs):
    with pytest.raises(InputError, match="try last"):
        recording_path("live")
    with CommandServer(runs / "old.mcap", {"state": lambda _: {}}):
        assert recording_path("live").name == "old.mcap"


@pytest.mark.parametrize(("name", "hint"), [("runs/odl.mcap", "did you mean 'old'"), ("x", "new")])
def test_an_unknown_recording_names_the_closest(runs, name, hint):
    with pytest.raises(InputError, match="no such recording") as told:
        recording_path(name)
    assert hint in str(told.value)


def test_without_any_recording_it_says_where_it_looked(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=f"no recording in {tmp_path}/runs"):
        recording_path("last")


@pytest.mark.parametrize(
    "arguments",
    [
        ["inspect", "last", "--plain"],
        ["ticks", "last"],
        ["why", "last"],
        ["why-not", "last", "work@0"],
        ["why-halted", "last", "work"],
        ["report", "last", "old"],
        ["cover", "last"],
        ["diff", "old", "last"],
    ],
)
def test_commands_understand_them(runs, arguments):
    result = CliRunner().invoke(main.app, arguments)
    assert result.exception is None or isinstance(result.exception, SystemExit), result.output


@pytest.mark.parametrize(
    "arguments", [["attach", "nowhere"], ["who", "nowhere", "key"], ["history", "nowhere", "key"]]
)
def test_commands_say_so_when_there_is_none(runs, arguments):
    result = CliRunner().invoke(main.app, arguments)
    assert "nowhere: no such recording" in str(result.exception)
