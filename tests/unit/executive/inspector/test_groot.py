"""Groot2's protocol shows what the recording holds, and takes whatever is sent to it."""

import itertools
import json
import socket
import threading
import time
from contextlib import contextmanager
from xml.etree import ElementTree

import pytest
import umsgpack
import zmq
from groot_client import Client, hook, request, statuses_in, transitions_in, unlock
from hypothesis import given
from hypothesis import strategies as st
from toy_pasts import RandomTree, act, past

from executive.core.errors import InputError
from executive.engine.ticks import NodeStatus
from executive.inspector.groot.answers import QUIET_S, Answers
from executive.inspector.groot.run_view import RunView
from executive.inspector.groot.server import GrootServer

CODES = {NodeStatus.RUNNING: 1, NodeStatus.SUCCESS: 2, NodeStatus.FAILURE: 3}
LETTERS = "TSBIRNUDAXrt"
ROOT = f"""
retry:
  times: 3
  child:
    reactive_sequence:
      name: safely
      children:
        - {act("door")}
        - sequence:
            name: work
            if: 1 < 2
            children:
              - {{skill: act, name: look, in: {{name: look, value: 2.5}}, out: {{value: $width}}}}
              - selector:
                  name: get
                  children: [{{when: width > 3, name: wide}}, {act("grasp")}, {act("open")}]
"""
SAID = {"door": "SSSSFS", "look": "RRSRS", "grasp": "RRRF", "open": "F"}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return past(tmp_path_factory.mktemp("run"), ROOT, SAID).recording


def answers_of(path, **more):
    return Answers(RunView(path, **more), steering=True)


@pytest.fixture
def answers(run):
    return answers_of(run.path)


def asked(answers, letter, *more):
    """Return the one frame after the header of a reply."""
    head, *body = answers.reply(request(letter, *more))
    assert head[:6] == request(letter)[0]
    assert len(body) == 1
    return body[0]


def error_of(answers, letter, *more):
    head, message = answers.reply(request(letter, *more))
    assert head == b"error"
    return message.decode()


def recorded(recording, tick):
    """Return the code of each node by number after a tick; idle ones are left out."""
    statuses = recording.statuses(tick)
    return {i + 1: CODES[s] for i, s in enumerate(statuses) if s is not NodeStatus.INVALID}


def busy(statuses):
    return {uid: status for uid, status in statuses.items() if 0 < status < 10}


def drawn(xml):
    """Return the number of each node's parent, uses of subtrees left out, and all elements."""
    root = ElementTree.fromstring(xml)
    blocks = {each.get("_fullpath"): each for each in root.findall("BehaviorTree")}
    parents, elements = {}, {}

    def visit(element, parent):
        uid = int(element.get("_uid"))
        assert uid not in elements
        elements[uid] = element
        if element.tag == "SubTree":
            for inner in blocks[element.get("_fullpath")]:
                visit(inner, parent)
            return
        parents[uid] = parent
        for child in element:
            visit(child, uid)

    visit(blocks[""][0], None)
    return parents, elements


@pytest.mark.parametrize("seed", range(12))
def test_the_tree_that_is_drawn_is_the_recorded_one(tmp_path, seed):
    tree = RandomTree(seed, most_leaves=12)
    letters = tree.letters(tree.random_answers())
    recording = past(tmp_path, tree.root, letters).recording
    parents, elements = drawn(asked(answers_of(recording.path), "T"))
    nodes = recording.header.nodes
    assert parents == {
        i + 1: None if node.parent is None else node.parent + 1 for i, node in enumerate(nodes)
    }
    for uid, element in elements.items():
        assert element.get("name") == nodes[uid - 1].name


def test_a_node_shows_what_it_was_given_and_its_model_names_every_port(answers):
    xml = asked(answers, "T")
    _, elements = drawn(xml)
    by_name = {element.get("name"): element for element in elements.values()}
    assert by_name["look"].get("value") == "{width}"
    assert by_name["wide"].get("code") == "width > 3"
    models = ElementTree.fromstring(xml).find("TreeNodesModel")
    known = {(model.get("ID"), port.get("name")) for model in models for port in model}
    for element in elements.values():
        ports = {*element.attrib} - {"name", "_uid", "_fullpath", "ID"}
        assert {(element.tag, port) for port in ports} <= known


def test_statuses_are_those_of_the_last_tick(run, answers):
    statuses = statuses_in(asked(answers, "S"))
    assert [*statuses] == [*range(1, len(run.header.nodes) + 1)]
    assert busy(statuses) == recorded(run, len(run) - 1)


def test_an_idle_node_tells_what_it_was_before(run):
    now = itertools.count()
    answers = answers_of(run.path, speed=0.05, now=lambda: next(now))
    before, seen = {}, set()
    for _ in range(400):
        statuses = statuses_in(asked(answers, "S"))
        for uid, status in statuses.items():
            if status > 10:
                assert status - 10 == before[uid]
                seen.add(status)
            elif status:
                before[uid] = status
    assert seen


def test_a_recording_is_played_along_the_clock_of_the_cell(run):
    now_s = 0.0
    answers = answers_of(run.path, speed=2.0, now=lambda: now_s)
    for step in range(40):
        now_s = step / 40
        expected = max(i for i in range(len(run)) if run.tick(i).time_s <= 2.0 * now_s)
        assert busy(statuses_in(asked(answers, "S"))) == recorded(run, expected)


def test_transitions_add_up_to_the_statuses(run):
    now_s = 0.0
    answers = answers_of(run.path, speed=1.0, now=lambda: now_s)
    state = statuses_in(asked(answers, "S"))
    assert int(asked(answers, "r", b"start")) > 0
    last_us, count = 0, 0
    for step in range(1, 20):
        now_s = step / 10
        statuses = statuses_in(asked(answers, "S"))
        for time_us, uid, status in transitions_in(asked(answers, "t")):
            assert time_us >= last_us
            last_us, state[uid], count = time_us, status, count + 1
        assert {u: s for u, s in state.items() if 0 < s < 10} == busy(statuses)
    assert count > 20
    assert answers.reply(request("r", b"stop"))[1:] == []
    now_s = 100.0
    assert transitions_in(asked(answers, "t")) == []


def test_a_blackboard_holds_the_recorded_values(run, answers):
    board = umsgpack.unpackb(asked(answers, "B", b"t"))
    assert board == {"t": {"width": 2.5}}
    assert umsgpack.unpackb(asked(answers, "B", b"")) == board
    assert umsgpack.unpackb(asked(answers, "B", b"nobody;t")) == board
    assert umsgpack.unpackb(asked(answers, "B", b"nobody")) is None


@given(
    st.lists(st.binary(max_size=200), max_size=4)
    | st.tuples(
        st.sampled_from([request(letter)[0] for letter in LETTERS]),
        st.binary(max_size=60)
        | st.recursive(
            st.none() | st.booleans() | st.integers() | st.text(max_size=5),
            lambda inner: (
                st.lists(inner, max_size=4)
                | st.dictionaries(
                    st.sampled_from(
                        ["uid", "position", "mode", "once", "enabled", "desired_status"]
                    ),
                    inner,
                )
            ),
        ).map(lambda value: json.dumps(value).encode()),
    )
)
def test_whatever_is_asked_is_answered(fuzzed, frames):
    reply = fuzzed.reply([*frames])
    assert reply
    assert all(isinstance(frame, bytes) for frame in reply)
    # The first byte is the version of the protocol, and each side tells its own.
    assert reply[0] == b"error" or reply[0][1:6] == frames[0][1:6]


@pytest.fixture(scope="module")
def fuzzed(run):
    return answers_of(run.path)


def test_a_deeply_nested_hook_is_refused(answers):
    assert error_of(answers, "I", b"[" * 100_000)


@pytest.mark.parametrize(
    ("letter", "more", "message"),
    [
        ("I", (hook(10_000),), "node 10000 not found"),
        ("I", (b"{}",), "uid is missing"),
        ("I", (), "EOF"),
        ("I", (hook(1, mode=1, status="RUNNING"),), "expected SUCCESS or FAILURE"),
        ("I", (hook(1, mode=1, status="SUCCESS", position=1),), "keeps its answer"),
        ("I", (hook(1),), "no running mission"),
        ("R", (unlock(1),), "no hook at node 1"),
        ("U", (unlock(1),), "no hook at node 1"),
        ("N", (), "not asked"),
        ("r", (b"begin",), "expected start or stop"),
    ],
)
def test_what_cannot_be_done_is_told(answers, letter, more, message):
    assert message in error_of(answers, letter, *more)
    assert json.loads(asked(answers, "D")) == []


def test_a_run_that_has_no_tick_yet_is_shown_idle(tmp_path, run):
    from executive.engine.recording.writer import RecordingWriter

    path = tmp_path / "new.mcap"
    with RecordingWriter(path, run.header) as writer:
        answers = answers_of(path)
        assert set(statuses_in(asked(answers, "S")).values()) == {0}
        assert umsgpack.unpackb(asked(answers, "B", b"t")) == {"t": {}}
        writer.on_tick(run.tick(0))
        assert busy(statuses_in(asked(answers, "S"))) == recorded(run, 0)


class Mission:
    """Stands for the process that runs a mission: remembers what it was told."""

    def __init__(self):
        self.told, self.breakpoints, self.forced, self.standing = [], [], {}, None
        self._count = 0

    def __call__(self, command, **arguments):
        arguments.pop("by", None)
        if command != "state":
            self.told.append((command, *arguments.values()))
        if command == "break":
            self._count += 1
            self.breakpoints.append({"number": self._count, "text": arguments["text"], "hits": 0})
        if command == "unbreak":
            self.breakpoints = [b for b in self.breakpoints if b["number"] != arguments["number"]]
        if command == "force":
            self.forced[arguments["nodes"]] = arguments["answer"]
        if command == "unforce":
            del self.forced[arguments["nodes"]]
        if command == "resume":
            self.standing = None
        return {
            "standing": self.standing,
            "breakpoints": self.breakpoints,
            "forced": self.forced,
        }

    def hit(self, which=0):
        """Stand at a breakpoint."""
        one = self.breakpoints[which]
        one["hits"] += 1
        self.standing = {"why": f"breakpoint {one['number']}: {one['text']}"}


@pytest.fixture
def mission():
    return Mission()


@pytest.fixture
def steered(run, mission):
    now_s = [0.0]
    answers = Answers(RunView(run.path), steering=True, send_command=mission, now=lambda: now_s[0])
    answers.wait = lambda seconds: now_s.__setitem__(0, now_s[0] + seconds)
    return answers


def path_of(run, uid):
    return run.header.nodes[uid - 1].path


def test_a_breakpoint_is_set_told_once_and_left(run, steered, mission):
    assert steered.reply(request("I", hook(3)))[1:] == []
    assert mission.told == [("break", f"{path_of(run, 3)} on start")]
    assert steered.tend() == []
    mission.hit()
    assert [uid for _, uid in steered.tend()] == [b"3"]
    assert steered.tend() == []
    steered.reply(request("U", unlock(3)))
    assert mission.told[1:] == [("resume",)]
    assert len(json.loads(asked(steered, "D"))) == 1
    mission.hit()
    steered.reply(request("U", unlock(3, status="FAILURE", remove=True)))
    assert mission.told[2:] == [
        ("force", path_of(run, 3), "failure", True),
        ("unbreak", 1),
        ("resume",),
    ]
    assert json.loads(asked(steered, "D")) == []


def test_a_mission_that_stands_elsewhere_is_not_let_go(steered, mission):
    steered.reply(request("I", hook(3)))
    mission.standing = {"why": "paused"}
    assert "does not stand" in error_of(steered, "U", unlock(3))
    steered.reply(request("A"))
    assert ("resume",) not in mission.told


def test_an_answer_is_forced_and_taken_back(run, steered, mission):
    steered.reply(request("I", hook(2, mode=1, status="SUCCESS")))
    assert mission.forced == {path_of(run, 2): "success"}
    assert json.loads(asked(steered, "D"))[0]["desired_status"] == "SUCCESS"
    steered.reply(request("R", unlock(2)))
    assert mission.forced == {}


def test_an_answer_that_was_forced_once_is_forgotten_when_it_was_given(steered, mission):
    steered.reply(request("I", hook(2, mode=1, status="FAILURE", once=True)))
    assert len(json.loads(asked(steered, "D"))) == 1
    mission.forced.clear()
    assert json.loads(asked(steered, "D")) == []


def test_several_hooks_come_at_once_and_go_at_once(steered, mission):
    several = json.dumps([json.loads(hook(1)), json.loads(hook(2, position=1))]).encode()
    steered.reply(request("I", several))
    assert [text.rpartition(" ")[2] for _, text in mission.told] == ["start", "end"]
    mission.hit(1)
    steered.reply(request("A"))
    assert mission.breakpoints == []
    assert mission.standing is None


def test_hooks_are_disabled_without_being_forgotten(steered, mission):
    steered.reply(request("I", hook(1)))
    steered.reply(request("X"))
    assert mission.breakpoints == []
    assert [each["enabled"] for each in json.loads(asked(steered, "D"))] == [False]
    steered.reply(request("I", hook(1)))
    assert len(mission.breakpoints) == 1


def test_a_client_that_goes_away_holds_no_mission(steered, mission):
    steered.reply(request("I", hook(1)))
    mission.hit()
    steered.wait(QUIET_S + 0.1)
    steered.tend()
    assert mission.breakpoints == []
    assert mission.standing is None
    steered.reply(request("S"))
    steered.tend()
    assert len(mission.breakpoints) == 1


def test_from_another_machine_nobody_steers(run, mission):
    answers = Answers(RunView(run.path), steering=False, send_command=mission)
    for letter in "IRUAX":
        assert "hooks are refused" in error_of(answers, letter, hook(1))
    assert mission.told == []
    assert statuses_in(asked(answers, "S"))


@contextmanager
def served(answers):
    server = GrootServer(answers, "127.0.0.1", 0)
    thread = threading.Thread(target=server.serve, daemon=True)
    thread.start()
    try:
        yield server.port
    finally:
        server.stop()
        thread.join(10.0)
        assert not thread.is_alive()


def test_a_client_hears_of_a_breakpoint_over_the_sockets(run, steered, mission):
    with served(steered) as port, Client(port) as client:
        assert client.ask("I", hook(2)) == []
        heard = []
        thread = threading.Thread(target=lambda: heard.append(client.heard()))
        thread.start()
        time.sleep(0.2)  # until the subscription has arrived
        mission.hit()
        thread.join(10.0)
        assert heard == [2]
        assert busy(statuses_in(client.ask("S")[0])) == recorded(run, len(run) - 1)


def test_garbage_on_the_sockets_ends_nothing(answers):
    with served(answers) as port:
        for address in (port, port + 1):
            with socket.create_connection(("127.0.0.1", address)) as raw:
                raw.sendall(bytes(range(256)) * 20)
        context = zmq.Context()
        dealer = context.socket(zmq.DEALER)
        dealer.connect(f"tcp://127.0.0.1:{port}")
        dealer.send_multipart([b"no", b"delimiter"])
        dealer.send_multipart([b"", b"x" * 2**21])
        dealer.send_multipart([b"", b""])
        with Client(port) as client:
            assert statuses_in(client.ask("S")[0])
        context.destroy(linger=0)


def test_a_port_that_is_taken_is_told(answers):
    with served(answers) as port, pytest.raises(InputError, match=f"ports {port} and {port + 1}"):
        GrootServer(answers, "127.0.0.1", port)


def test_btview_reads_the_tree_statuses_and_blackboard(run, answers):
    btview = pytest.importorskip("btview.client")
    with served(answers) as port:
        client = btview.Groot2Client(port=port)
        tree = client.fetch_tree()
        by_uid = {node.uid: node.name for root in tree.roots for node in root.walk()}
        nodes = run.header.nodes
        assert by_uid == {i + 1: node.name for i, node in enumerate(nodes)}
        statuses = {uid: state.raw for uid, state in client.poll().statuses.items()}
        assert busy(statuses) == recorded(run, len(run) - 1)
        assert client.fetch_blackboard() == {"t": {"width": 2.5}}
        client.close()
