"""The server of the page answers out of one recording, and lets nobody else in."""

import json
import time

import numpy as np
import pytest
from py_trees.composites import Sequence
from starlette.testclient import TestClient
from starlette.websockets import WebSocketDisconnect
from toy_runs import FAILURE, RUNNING, SUCCESS, Leaf, busy_tree, record

from executive.engine.blackboard import Blackboard
from executive.engine.running.remote import CommandServer
from executive.engine.ticks import NodeStatus
from executive.inspector.activity import Activity, Code
from executive.inspector.web.server import application
from executive.inspector.web.session import Session

HERE = "http://127.0.0.1"
# Websockets of the test client name another host unless they are told.
LOCAL = {"host": "127.0.0.1"}


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    board = Blackboard()
    file = tmp_path_factory.mktemp("run") / "run.mcap"
    record(file, busy_tree(board), board)
    return file


@pytest.fixture(scope="module")
def session(path):
    return caught_up(Session(path))


def caught_up(session):
    """Wait until the lanes show all that had been recorded."""
    while not session.complete:
        time.sleep(0.01)
    return session


@pytest.fixture
def client(session):
    return TestClient(application(session), base_url=HERE)


def test_the_run_is_described_with_its_nodes_and_outcome(client, session):
    run = client.get("/api/run").json()
    assert [node["path"] for node in run["nodes"]] == [
        node.path for node in session.recording.header.nodes
    ]
    assert run["ended"]
    assert run["ticks"] == len(session.recording)
    assert run["report"]["outcome"] == "failure"


@pytest.mark.parametrize("number", [0, 255, 256, 300])
def test_a_tick_says_what_the_recording_says(client, session, number):
    tick = client.get(f"/api/tick/{number}").json()
    recording = session.recording
    assert tick["statuses"] == [status.value for status in recording.statuses(number)]
    assert tuple(tick["visited"]) == recording.tick(number).visited
    assert {row["key"] for row in tick["board"]} == set(recording.blackboard(number))


def test_lanes_show_every_tick_where_there_is_room(client, session):
    recording, nodes = session.recording, len(session.recording.header.nodes)
    answer = client.get("/api/lanes?from=10&to=59&columns=500")
    codes = np.frombuffer(answer.content, np.uint8).reshape(nodes, 50)
    for column in range(50):
        tick = recording.tick(10 + column)
        halted = {halt.node for halt in tick.halts}
        for node in range(nodes):
            if node not in tick.visited and node not in halted:
                assert codes[node, column] == Code.NOTHING
            if node in halted:
                assert codes[node, column] == Code.HALTED


def test_failures_survive_any_squeezing(session):
    recording = session.recording
    activity = Activity(len(recording.header.nodes))
    activity.follow(recording)
    last = len(recording) - 1
    whole = activity.lanes(0, last, last + 1)
    for columns in (1, 7, 100):
        squeezed = activity.lanes(0, last, columns)
        assert squeezed.shape == (len(whole), columns)
        assert (squeezed.max(axis=1) == whole.max(axis=1)).all()


@pytest.mark.parametrize(("direction", "least"), [("1", 100), ("-1", -1)])
def test_the_next_failure_is_one_and_there_is_none_between(client, session, direction, least):
    recording = session.recording
    work = next(n.path for n in recording.header.nodes if n.name == "guard")
    wish = {"kind": "failure", "from": 100, "direction": direction, "node": work}
    found = client.get("/api/find", params=wish).json()["tick"]
    index = [n.path for n in recording.header.nodes].index(work)
    assert recording.statuses(found)[index] is NodeStatus.FAILURE
    assert (found > 100) is (least == 100)


def test_ticks_are_found_by_expression(client, session):
    wish = {"kind": "where", "from": 0, "where": "count > 100"}
    found = client.get("/api/find", params=wish).json()["tick"]
    board = session.recording.blackboard
    assert board(found)["toy:count"].value > 100
    assert board(found - 1)["toy:count"].value <= 100


def test_a_failure_is_explained_and_a_value_has_its_writer(client):
    answer = client.get("/api/ask", params={"node": "mission/wait/guard", "tick": 300}).json()
    assert "guard" in answer["answers"][0]["answer"]
    who = client.get("/api/who", params={"key": "toy:count", "tick": 300}).json()
    assert who["writer"] == "mission/guard"
    assert who["tick"] <= 300


def test_the_report_is_a_page_without_foreign_markup(client):
    html = client.get("/api/report").json()["html"]
    assert "<table>" in html
    assert "<script" not in html


@pytest.mark.parametrize(
    ("address", "message"),
    [
        ("/api/tick/100000", "expected 0 to"),
        ("/api/lanes?from=a&to=2&columns=3", "expected a whole number"),
        ("/api/lanes?from=0&to=2&columns=0", "at least 1"),
        ("/api/find?kind=chang&from=0", "did you mean 'change'"),
        ("/api/find?kind=where&from=0&where=1+%2B", "not an expression"),
        ("/api/ask?node=mision&tick=1", "did you mean 'mission'"),
        ("/api/who?key=cout&tick=1", "did you mean"),
        ("/api/image/7.png", "has no message 7"),
    ],
)
def test_bad_questions_are_answered(client, address, message):
    answer = client.get(address)
    assert answer.status_code == 400
    assert message in answer.json()["error"]


def test_a_mission_that_has_ended_takes_no_commands(client):
    answer = client.post("/api/command", json={"command": "pause"}, headers={"origin": HERE})
    assert answer.status_code == 409


def test_commands_reach_the_run_and_say_who_sent_them(client, path):
    heard = []
    with CommandServer(path, {"pause": lambda sent: heard.append(dict(sent)) or {"paused": True}}):
        answer = client.post("/api/command", json={"command": "pause"}, headers={"origin": HERE})
    assert answer.json() == {"answer": {"paused": True}}
    assert heard == [{"by": "page"}]


def test_the_page_hears_at_once_how_far_the_run_is(client):
    with client.websocket_connect("/api/live", headers={**LOCAL, "origin": HERE}) as live:
        progress = json.loads(live.receive_text())
        assert progress["ended"]


def test_the_page_hears_of_a_run_that_grows(path, tmp_path):
    """A late client catches up, and later ticks reach it while the file grows."""
    whole = path.read_bytes()
    growing = tmp_path / "growing.mcap"
    growing.write_bytes(whole[: len(whole) // 2])
    session = Session(growing)
    before = len(session.recording)

    client = TestClient(application(session), base_url=HERE)
    with client.websocket_connect("/api/live", headers={**LOCAL, "origin": HERE}) as live:
        first = json.loads(live.receive_text())
        assert first["ticks"] == before
        assert not first["ended"]
        with growing.open("ab") as file:
            file.write(whole[len(whole) // 2 :])
        last = first
        while not last["complete"]:
            last = json.loads(live.receive_text())
    assert last["ticks"] > before
    assert len(client.get("/api/lanes?from=0&to=9999&columns=4000").content) == (
        last["ticks"] * len(session.recording.header.nodes)
    )


@pytest.mark.parametrize(
    "headers",
    [
        {"host": "evil.example"},
        {"host": "127.0.0.1.evil.example"},
        {"host": "[::1"},
        LOCAL | {"origin": "http://["},
        {"origin": "http://evil.example"},
        {"origin": "null"},
    ],
)
def test_foreign_pages_and_names_are_refused(client, headers):
    assert client.get("/api/run", headers=headers).status_code == 403
    assert client.post("/api/command", json={}, headers=headers).status_code == 403
    with pytest.raises(WebSocketDisconnect):
        client.websocket_connect("/api/live", headers=headers).__enter__()


def test_requests_without_a_page_may_look_and_change_nothing(client):
    assert client.get("/api/run").status_code == 200
    assert client.post("/api/command", json={"command": "stop"}).status_code == 403


def test_a_token_is_needed_where_others_can_connect(session):
    app = application(session, token="secret")
    client = TestClient(app, base_url="http://cell.example")
    assert client.get("/").status_code == 403
    assert client.get("/?token=wrong").status_code == 403
    assert client.get("/?token=secret").status_code == 200
    assert client.get("/api/run").status_code == 200  # by the cookie


def test_a_picture_says_when_it_was_taken(tmp_path):
    board = Blackboard()

    def look():
        board.write("toy:image", np.zeros((4, 6), np.uint8), "mission/look")
        return SUCCESS

    wait = Leaf("wait", RUNNING, RUNNING, RUNNING, FAILURE)
    tree = Sequence("mission", memory=True, children=[Leaf("look", look), wait])
    record(tmp_path / "seen.mcap", tree, board)
    session = Session(tmp_path / "seen.mcap")
    last = session.tick(len(session.recording) - 1)
    picture = last["picture"]
    assert picture["time_s"] == session.recording.tick(picture["tick"]).time_s
    assert picture["time_s"] < last["time_s"]
