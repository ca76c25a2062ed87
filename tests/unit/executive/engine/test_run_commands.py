"""A running mission is commanded from outside through the socket of its recording."""

import pytest
from test_debugger import Debugged
from toy_language import Bench

from executive.core.errors import InputError
from executive.engine.debugging.commands import RunCommands
from executive.engine.running.remote import CommandServer, send


@pytest.fixture
def run(tmp_path):
    return Debugged(Bench(tmp_path))


@pytest.fixture
def recording(run, tmp_path):
    path = tmp_path / "run.mcap"
    with CommandServer(path, RunCommands(run.control, run.debugger).by_name()):
        yield path


def test_a_mission_is_paused_stepped_and_resumed_from_outside(run, recording):
    assert send(recording, "pause")["breakpoints"] == []
    run.start().stands()
    send(recording, "step")
    run.stands()
    assert len(run.ticks) == 1
    assert send(recording, "break", text="labour on end")["breakpoints"][0]["hits"] == 0
    assert send(recording, "resume")["stopping"] == ""
    standing = run.stands()
    assert standing.node == "t/rounds/round/labour"
    state = send(recording, "state")
    assert state["paused"]
    assert state["standing"]["node"] == standing.node
    assert state["breakpoints"][0]["hits"] == 1
    send(recording, "unbreak", number=1)
    assert run.finish().outcome == "success"


def test_forced_answers_are_listed_and_recorded(run, recording):
    state = send(recording, "force", nodes="labour", answer="failure", once=True, by="a test")
    assert state["forced"] == {"t/rounds/round/labour": "failure"}
    assert send(recording, "unforce", nodes="labour")["forced"] == {}
    notes = run.debugger.interventions.drain(0.0)
    assert [b'"by":"a test"' in note.data for note in notes] == [True, False]


def test_a_stop_says_who_asked_for_it(run, recording):
    send(recording, "pause")
    run.start().stands()
    send(recording, "stop", by="the page")
    run._thread.join(10.0)
    assert "the page" in run.result.reason


@pytest.mark.parametrize(
    ("command", "arguments", "message"),
    [
        ("step", {"step": "sideways"}, "step"),
        ("step", {}, "not paused"),
        ("break", {}, "text"),
        ("break", {"text": "nobody"}, "no node"),
        ("unbreak", {"number": 7}, "no breakpoint 7"),
        ("force", {"nodes": "labour", "answer": "maybe"}, "did you mean|known"),
        ("pause", {"speed": 3}, "speed"),
    ],
)
def test_bad_commands_are_answered_and_change_nothing(run, recording, command, arguments, message):
    before = send(recording, "state")
    with pytest.raises(InputError, match=message):
        send(recording, command, **arguments)
    assert send(recording, "state") == before
