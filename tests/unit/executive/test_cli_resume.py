"""`cellwright resume`: what it lists, what it refuses, and how it says so."""

import json

import pytest
import toy_cellwright
from typer.testing import CliRunner

from executive.cli.main import app
from executive.core.errors import InputError
from executive.engine.recording.reader import Recording


@pytest.fixture
def whole(tmp_path, monkeypatch):
    """Record a toy mission with a checkpoint, and stand in its folder."""
    monkeypatch.chdir(tmp_path)
    for module, name, toy in toy_cellwright.replacements():
        monkeypatch.setattr(module, name, toy)
    file = toy_cellwright.write_mission(tmp_path)
    file.write_text(file.read_text().replace("toy_move, in", "toy_move, checkpoint: true, in"))
    assert invoke("run", "toy.yaml", "--record", "whole.mcap").exit_code == 0
    return tmp_path / "whole.mcap"


def invoke(*words):
    return CliRunner().invoke(app, [str(word) for word in words])


def test_checkpoints_are_listed_for_people_and_as_json(whole):
    listed = invoke("resume", whole, "--list").stdout
    assert listed.split() == ["0", "0.00", "s", "toy/toy_move@0"]
    (document,) = json.loads(invoke("resume", whole, "--list", "--json").stdout)
    assert document == {
        **{"name": "toy/toy_move@0", "node": "toy/toy_move", "tick": 0},
        **{"time_s": 0.0, "refused": ""},
    }


def test_what_cannot_be_resumed_is_bad_input_that_says_why(whole):
    for words, reason in (
        ((), "has ended with success after"),
        (("--from", "nowhere"), "no checkpoint 'nowhere'"),
        (("--from", "toy_move"), "cannot be put back into the state of then"),
    ):
        answer = invoke("resume", whole, *words, "--json")
        assert answer.exit_code == 2
        report = json.loads(answer.stdout)
        assert report["outcome"] == "error"
        assert reason in report["reason"]
        assert report["recording"] is None


def test_an_earlier_checkpoint_is_gone_on_from_when_it_is_named(whole):
    answer = invoke(
        *("resume", whole, "--from", "toy_move", "--as-it-stands"),
        *("--record", "again.mcap", "--json"),
    )
    assert answer.exit_code == 0
    assert "goes on at toy/toy_move, tick 0, 0.0 s" in answer.stderr
    assert json.loads(answer.stdout)["claim"] == {"untangled": True, "knotted_probability": 0.02}
    assert Recording.open(whole.parent / "again.mcap").header.resumed_from.file == str(whole)


def test_a_recording_is_not_written_over_itself(whole):
    before = whole.read_bytes()
    answer = invoke("resume", whole, "--from", "toy_move", "--as-it-stands", "--record", whole)
    assert answer.exit_code == 2
    assert "is the recording to go on from" in answer.stderr
    assert whole.read_bytes() == before


def test_a_file_that_is_no_recording_is_told(whole):
    (whole.parent / "other.mcap").write_bytes(b"other")
    answer = invoke("resume", "other.mcap")
    assert isinstance(answer.exception, InputError)
