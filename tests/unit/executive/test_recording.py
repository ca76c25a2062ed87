"""A recording says what every tick did, survives a kill, and is the same for the same run."""

import json
import signal
import subprocess
import sys
from dataclasses import dataclass
from enum import StrEnum
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from PIL import Image
from py_trees.common import Status
from py_trees.decorators import Retry
from toy_runs import Leaf, built, busy_tree, header_of, record

from executive.core.errors import RecordingError
from executive.core.outcome import failure
from executive.engine.blackboard import Blackboard
from executive.engine.recording.fingerprint import status_fingerprint
from executive.engine.recording.reader import Recording
from executive.engine.recording.values import ValueEncoder
from executive.engine.recording.writer import RecordingWriter
from executive.engine.ticks import NodeStatus

RUNNING, SUCCESS, FAILURE = Status.RUNNING, Status.SUCCESS, Status.FAILURE


def test_statuses_at_any_tick_are_those_of_the_tree(tmp_path):
    recording, live = record(tmp_path / "a.mcap", busy_tree())
    assert recording.complete
    assert len(recording) == len(live) > 512
    statuses = [NodeStatus.INVALID] * 5
    for tick in live:
        for node, status in tick.changes:
            statuses[node] = status
        assert recording.statuses(tick.number) == tuple(statuses)


def test_what_is_read_back_is_what_was_told_live(tmp_path):
    recording, live = record(tmp_path / "a.mcap", busy_tree())
    assert list(recording.ticks()) == live


def test_blackboard_and_reasons_at_any_tick_name_the_last_write_and_the_last_failure(tmp_path):
    blackboard = Blackboard()
    recording, live = record(tmp_path / "a.mcap", busy_tree(blackboard), blackboard)
    for number in (6, 300, 599):
        state = recording.blackboard(number)["toy:count"]
        writes = [tick for tick in live[: number + 1] if tick.writes]
        assert (state.tick, state.writer) == (writes[-1].number, "mission/guard")
        ends = [e for tick in live[: number + 1] for e in tick.outcomes if e.node == 2]
        assert recording.reasons(number).get(2) == ends[-1].reason


def test_values_are_kept_as_they_were_when_written(tmp_path):
    blackboard, goal = Blackboard(), {"x": 1}

    def move():
        goal["x"] += 1
        blackboard.write("toy:goal", goal, "work")
        return RUNNING if goal["x"] < 4 else SUCCESS

    recording, _ = record(tmp_path / "a.mcap", Leaf("work", move), blackboard)
    assert [recording.blackboard(k)["toy:goal"].value for k in range(3)] == [
        {"x": 2},
        {"x": 3},
        {"x": 4},
    ]


def test_images_are_stored_once_and_referred_to(tmp_path):
    blackboard = Blackboard()
    image = np.random.default_rng(0).integers(0, 255, (40, 60), dtype=np.uint8)

    def look():
        blackboard.write("toy:frame", {"image": image}, "look")
        return RUNNING if len(leaf.answers) > 1 else SUCCESS

    leaf = Leaf("look", look, look, look)
    recording, _ = record(tmp_path / "a.mcap", leaf, blackboard)
    (stored,) = recording.images()
    value = recording.blackboard(1)["toy:frame"].value
    assert value == {"image": {"$type": "image", "image": stored.number, "shape": [40, 60]}}
    assert np.array_equal(np.asarray(Image.open(BytesIO(stored.png))), image)


def test_any_mcap_reader_opens_it_and_finds_schemas(tmp_path):
    recording, _ = record(tmp_path / "a.mcap", busy_tree())
    with recording.path.open("rb") as file:
        summary = make_reader(file).get_summary()
        topics = {channel.topic for channel in summary.channels.values()}
        assert topics == {"/mission", "/ticks", "/result", "/toy"}
        for schema in summary.schemas.values():
            assert schema.encoding == "jsonschema"
            assert json.loads(schema.data)["type"] == "object"


def test_streams_of_the_cell_come_back(tmp_path):
    recording, _ = record(tmp_path / "a.mcap", Leaf("work", RUNNING, RUNNING, SUCCESS))
    messages = list(recording.streams())
    assert {message.topic for message in messages} == {"/toy"}
    assert messages[0].schema == "toy.Beat"
    assert [message.time_s for message in messages] == pytest.approx([0.1, 0.2, 0.2])


def test_the_same_seed_gives_the_same_fingerprint_and_another_seed_another(tmp_path):
    prints = [
        status_fingerprint(record(tmp_path / f"{i}.mcap", busy_tree(seed=seed))[0])
        for i, seed in enumerate((1, 1, 2))
    ]
    assert prints[0] == prints[1] != prints[2]


def test_every_cut_of_the_file_gives_a_prefix_of_its_ticks(tmp_path):
    recording, live = record(tmp_path / "whole.mcap", busy_tree())
    data = recording.path.read_bytes()
    cut = tmp_path / "cut.mcap"
    seen = []
    for size in np.linspace(3000, len(data) - 1, 25).astype(int):
        cut.write_bytes(data[:size])
        part = Recording.open(cut)
        assert not part.complete
        assert list(part.ticks()) == live[: len(part)]
        seen.append(len(part))
    assert seen == sorted(seen)
    assert seen[-1] == len(live)


def test_a_damaged_file_gives_a_prefix_or_a_clear_error_and_never_a_wrong_tick(tmp_path):
    recording, live = record(tmp_path / "whole.mcap", busy_tree())
    data, rng = recording.path.read_bytes(), np.random.default_rng(0)
    damaged = tmp_path / "damaged.mcap"
    lengths = []
    for _ in range(40):
        changed = bytearray(data)
        changed[rng.integers(len(data))] ^= 1 << rng.integers(8)
        damaged.write_bytes(changed)
        try:
            part = Recording.open(damaged)
        except RecordingError:
            continue
        assert list(part.ticks()) == live[: len(part)]
        lengths.append(len(part))
    assert len(live) in lengths
    assert any(0 < length < len(live) for length in lengths)


@pytest.mark.parametrize("content", [b"", b"no recording", None])
def test_a_file_that_is_no_recording_is_refused_with_a_hint(tmp_path, content):
    path = tmp_path / "x.mcap"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(RecordingError, match=r"x\.mcap.*expected an MCAP file.*try"):
        Recording.open(path)


def test_a_tick_that_is_not_there_is_refused_with_the_range(tmp_path):
    recording, _ = record(tmp_path / "a.mcap", Leaf("work", RUNNING, SUCCESS))
    with pytest.raises(RecordingError, match="no tick 9; expected 0 to 1"):
        recording.tick(9)


def test_a_place_that_cannot_be_written_is_refused_with_a_hint(tmp_path):
    (tmp_path / "file").write_text("")
    header = header_of(built(Leaf("work", SUCCESS)))
    with pytest.raises(RecordingError, match="try --record"):
        RecordingWriter(tmp_path / "file" / "a.mcap", header)


KILLED = """
import os, signal, sys
from py_trees.decorators import Retry
sys.path.insert(0, {tests!r})
from pathlib import Path
from toy_runs import Leaf, ToyCell, built, header_of
from executive.core.outcome import failure
from executive.engine.recording.writer import RecordingWriter
from executive.engine.running.runner import Runner

count = 0
def work():
    global count
    count += 1
    if count == 40:
        os.kill(os.getpid(), signal.SIGKILL)
    return failure("work.missed", str(count))

tree = built(Retry("again", Leaf("work", work), 1000))
writer = RecordingWriter(Path(sys.argv[1]), header_of(tree))
Runner(tree, ToyCell(), tick_hz=10.0, observers=(writer,)).run()
"""


def test_a_killed_process_loses_only_the_tick_in_progress(tmp_path):
    path = tmp_path / "killed.mcap"
    script = KILLED.format(tests=str(Path(__file__).parent))
    ended = subprocess.run([sys.executable, "-c", script, str(path)], check=False)
    assert ended.returncode == -signal.SIGKILL
    recording = Recording.open(path)
    assert (recording.complete, recording.result) == (False, None)
    assert len(recording) == 39
    assert recording.reasons(38)[1].text == "39"


def test_actions_are_the_activations_of_acting_skills(tmp_path):
    missed = failure("grasp.missed", "nothing held")
    pull = Leaf("pull", RUNNING, RUNNING, missed, missed, RUNNING, SUCCESS)
    root = Retry("mission", pull, 5)
    recording, _ = record(tmp_path / "a.mcap", root, acting=("pull",))
    actions = recording.result.report.actions
    assert [(action.name, action.status, action.reason) for action in actions] == [
        ("pull", "failure", "grasp.missed: nothing held"),
        ("pull", "failure", "grasp.missed: nothing held"),
        ("pull", "success", ""),
    ]
    assert [action.start_s for action in actions] == pytest.approx([0.0, 0.3, 0.4])
    assert [action.duration_s for action in actions] == pytest.approx([0.2, 0.0, 0.1])


def test_an_action_that_is_halted_says_by_whom(tmp_path):
    recording, _ = record(
        tmp_path / "a.mcap", Leaf("pull", RUNNING), acting=("pull",), timeout_s=0.3
    )
    (action,) = recording.result.report.actions
    assert (action.status, action.reason) == ("halted", "halted by the runner")


class Colour(StrEnum):
    RED = "red"


@dataclass(frozen=True)
class Thing:
    colour: Colour
    place: tuple[float, float]
    points: np.ndarray


def test_values_become_json_that_says_what_they_were():
    encode = ValueEncoder(lambda image: 7).encode
    thing = Thing(Colour.RED, (1.0, float("nan")), np.array([[1.0, np.inf]]))
    encoded = encode({"thing": thing, "raw": b"ab", 3: {"set"}})
    assert json.loads(json.dumps(encoded, allow_nan=False)) == encoded
    fields = encoded["items"][0][1]
    assert fields["$type"] == f"{__name__}.Thing"
    assert fields["colour"] == {"$type": f"{__name__}.Colour", "name": "RED", "value": "red"}
    assert fields["place"] == {
        "$type": "tuple",
        "items": [1.0, {"$type": "float", "value": "nan"}],
    }
    assert fields["points"]["values"] == [[1.0, "inf"]]
    assert np.array(fields["points"]["values"], float).tolist() == thing.points.tolist()


def test_large_arrays_are_named_by_hash_and_images_by_number():
    encode = ValueEncoder(lambda image: 7).encode
    depth = encode(np.zeros((200, 300), np.float32))
    assert (depth["shape"], depth["dtype"]) == ([200, 300], "float32")
    assert depth["hash"] == encode(np.zeros((200, 300), np.float32))["hash"]
    assert depth["hash"] != encode(np.ones((200, 300), np.float32))["hash"]
    assert encode(np.zeros((200, 300), np.uint8))["image"] == 7


def test_what_json_cannot_say_is_described_without_addresses():
    encoded = ValueEncoder(lambda image: 0).encode(object())
    assert encoded == {"$type": "object", "repr": "<object object>"}
