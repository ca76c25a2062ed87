"""A mission runs in one process; clients of Groot2 watch and steer it from another."""

import json
import subprocess
import sys
import threading
import time
from contextlib import contextmanager
from xml.etree import ElementTree

import pytest
import umsgpack
from groot_client import Client, hook, statuses_in, unlock

from executive.engine.recording.reader import Recording
from executive.engine.running.remote import NotRunningError, send
from executive.inspector.groot.answers import Answers
from executive.inspector.groot.run_view import RunView
from executive.inspector.groot.server import GrootServer
from executive.inspector.past import PastRun

LIMIT_S = 60.0
RUNNING, SUCCESS, FAILURE = 1, 2, 3
FILES = {
    "fetch.yaml": """
format: 1
mission: fetch
cell: dry
timeout_s: 60.0
root: {subtree: job}
""",
    "job.yaml": """
format: 1
tree: job
uses: [fetch_stubs]
root:
  sequence:
    children:
      - {skill: look, out: {pose: $pose}}
      - {subtree: take, name: take_part, in: {pose: $pose}}
      - {skill: put}
""",
    "take.yaml": """
format: 1
tree: take
uses: [fetch_stubs]
in: {pose: {type: "list[float]"}}
root:
  sequence:
    children:
      - {set: {tries: 1}}
      - {skill: grasp, in: {pose: $pose}}
""",
    "fetch_stubs.yaml": """
format: 1
stubs: fetch_stubs
skills:
  look:
    out: {pose: {type: "list[float]"}}
    outcomes: [{ticks: 2, outcome: success, out: {pose: [0.4, 0.1]}}]
  grasp:
    in: {pose: {type: "list[float]"}}
    outcomes: [{ticks: 3, outcome: success}]
  put: {outcomes: [{outcome: success}]}
""",
}


@pytest.fixture
def mission(tmp_path):
    """Start a mission that is paused before its first tick; return its recording."""
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    command = "from executive.cli.main import main; main()"
    arguments = ("run", "fetch.yaml", "--record", "run.mcap", "--paused")
    process = subprocess.Popen(
        [sys.executable, "-c", command, *arguments],
        cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
    )  # fmt: skip
    path = tmp_path / "run.mcap"
    until(lambda: paused(path))
    yield path
    process.communicate(timeout=LIMIT_S)


def until(reached):
    end_s = time.monotonic() + LIMIT_S
    while not reached():
        assert time.monotonic() < end_s
        time.sleep(0.02)


def paused(path):
    try:
        return send(path, "state")["paused"]
    except NotRunningError:
        return False


@contextmanager
def served(path):
    server = GrootServer(Answers(RunView(path), steering=True), "127.0.0.1", 0)
    thread = threading.Thread(target=server.serve, daemon=True)
    thread.start()
    yield server.port
    server.stop()
    thread.join(LIMIT_S)


def test_a_mission_is_watched_and_steered_while_it_runs(mission):
    with served(mission) as port, Client(port) as client:
        xml = ElementTree.fromstring(client.ask("T")[0])
        uids = {each.get("name"): int(each.get("_uid")) for each in xml.iter() if each.get("_uid")}
        use = next(each for each in xml.iter("SubTree") if each.get("_uid"))
        assert use.get("ID") == "take"

        assert set(statuses_in(client.ask("S")[0]).values()) == {0}
        assert client.ask("I", hook(uids["grasp"])) == []
        time.sleep(0.2)  # until the subscription has arrived
        send(mission, "resume")
        assert client.heard() == uids["grasp"]

        # It stands in the middle of a tick, which is not written yet.
        statuses = statuses_in(client.ask("S")[0])
        assert statuses[uids["look"]] == RUNNING
        assert client.ask("I", hook(uids["put"])) == []
        assert client.ask("U", unlock(uids["grasp"], remove=True)) == []
        assert client.heard() == uids["put"]
        statuses = statuses_in(client.ask("S")[0])
        assert statuses[uids["look"]] == SUCCESS
        assert statuses[uids["grasp"]] == RUNNING
        assert statuses[int(use.get("_uid"))] == RUNNING
        board = umsgpack.unpackb(client.ask("B", b"fetch;fetch/take_part")[0])
        assert board == {"fetch": {"pose": [0.4, 0.1]}, "fetch/take_part": {"tries": 1}}
        assert [each["uid"] for each in json.loads(client.ask("D")[0])] == [uids["put"]]

        assert client.ask("U", unlock(uids["put"], status="FAILURE")) == []
        until(lambda: not paused(mission) and Recording.open(mission).result is not None)
        until(lambda: statuses_in(client.ask("S")[0])[uids["put"]] == FAILURE)
        assert client.ask("U", unlock(uids["put"]))[0] == b"error"
    assert "debug.forced" in Recording.open(mission).result.report.reason
    # The keys of a tree at another's root have a name of their own; who reads them is known.
    run = PastRun.open(mission)
    (grasp,) = run.names.nodes("grasp")
    assert run.reads[grasp] == {"fetch.job:pose"}


def test_a_server_that_ends_leaves_no_hook_behind(mission):
    with served(mission) as port, Client(port) as client:
        assert client.ask("I", hook(1)) == []
        assert len(send(mission, "state")["breakpoints"]) == 1
    assert send(mission, "state")["breakpoints"] == []
    send(mission, "resume")
