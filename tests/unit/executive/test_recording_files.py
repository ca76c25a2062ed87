"""The files of a recording: readable by anybody at any moment, bounded, packed at the end."""

import errno
import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import NonSeekingReader, make_reader
from toy_runs import Leaf, built, busy_tree, header_of, record

from executive.core.errors import RecordingError
from executive.core.outcome import Reason
from executive.core.world import StreamMessage
from executive.engine.blackboard import Write
from executive.engine.recording import parts
from executive.engine.recording.decoding import decode
from executive.engine.recording.large import LargeValues
from executive.engine.recording.messages import TickMessage
from executive.engine.recording.parts import parts_of
from executive.engine.recording.reader import Recording
from executive.engine.recording.tickjson import TickEncoder
from executive.engine.recording.values import ValueEncoder
from executive.engine.recording.writer import RecordingWriter
from executive.engine.ticks import Halt, NodeFault, NodeOutcome, NodeStatus, SlowStep, Tick

HEADER = header_of(built(Leaf("look", NodeStatus.RUNNING)))


def tick_of(number, image=None):
    writes = () if image is None else (Write("toy:image", image, "look"),)
    return Tick(number, 0.1 * number, 1e-4, visited=(0,), writes=writes)


def numbers_in(path):
    """Return the numbers of the ticks that MCAP's own reader finds before the file ends."""
    found = []
    with path.open("rb") as file:
        try:
            for _, channel, message in NonSeekingReader(file).iter_messages(log_time_order=False):
                if channel.topic == "/ticks":
                    found.append(json.loads(message.data)["tick"])
        except Exception:  # the file ends in the middle of a record
            return found
    return found


def test_while_it_is_written_every_tick_is_there_for_mcaps_own_reader(tmp_path):
    path = tmp_path / "live.mcap"
    with RecordingWriter(path, HEADER) as writer:
        for number in range(20):
            writer.on_tick(tick_of(number))
            writer.on_streams([StreamMessage("/toy", "Toy", 0.1 * number, b"{}")])
            assert numbers_in(path) == list(range(number + 1))
            assert len(Recording.open(path)) == number + 1
            assert len(list(Recording.open(path).streams())) == number + 1


def test_every_cut_of_an_unfinished_file_keeps_the_ticks_before_the_cut(tmp_path):
    path, cut = tmp_path / "live.mcap", tmp_path / "cut.mcap"
    sizes = []
    writer = RecordingWriter(path, HEADER)
    for number in range(12):
        writer.on_tick(tick_of(number))
        sizes.append(path.stat().st_size)
    data = path.read_bytes()
    writer.close()
    for size in range(sizes[0], len(data), 5):
        cut.write_bytes(data[:size])
        whole = sum(size >= end for end in sizes)
        assert numbers_in(cut) == list(range(whole))
        assert len(Recording.open(cut)) == whole


def test_a_closed_file_is_indexed_and_smaller(tmp_path):
    recording, live = record(tmp_path / "a.mcap", busy_tree())
    with recording.path.open("rb") as file:
        reader = make_reader(file)
        summary = reader.get_summary()
        assert summary.statistics.chunk_count == len(summary.chunk_indexes) > 2
        ticks = [message.data for _, _, message in reader.iter_messages(["/ticks"])]
    assert len(ticks) == len(live)
    assert recording.path.stat().st_size < 0.5 * sum(len(data) + 31 for data in ticks)
    assert list(tmp_path.iterdir()) == [recording.path]


def test_without_room_for_packing_the_first_file_stays(tmp_path, monkeypatch):
    path = tmp_path / "a.mcap"
    writer = RecordingWriter(path, HEADER)
    for number in range(5):
        writer.on_tick(tick_of(number))

    class Full(parts.McapFile):
        def add(self, item):
            raise OSError(errno.ENOSPC, "no space left on device")

    monkeypatch.setattr(parts, "McapFile", Full)
    writer.close()
    recording = Recording.open(path)
    assert (len(recording), recording.complete) == (5, True)
    assert list(tmp_path.iterdir()) == [path]


def write_parts(path, ticks=400):
    """Write a recording of several parts; return its images."""
    rng = np.random.default_rng(0)
    images = [rng.integers(0, 255, (20, 30), dtype=np.uint8) for _ in range(3)]
    with RecordingWriter(path, HEADER, part_bytes=8000) as writer:
        for number in range(ticks):
            writer.on_tick(tick_of(number, images[number // 40 % 3] if number % 40 == 0 else None))
    return images


def test_parts_are_read_as_one_recording(tmp_path):
    images = write_parts(tmp_path / "a.mcap")
    files = parts_of(tmp_path / "a.mcap")
    assert len(files) > 4
    assert sorted(tmp_path.iterdir()) == sorted(files)
    for path in (files[0], files[2]):
        recording = Recording.open(path)
        assert (len(recording), recording.complete) == (400, True)
        assert [tick.number for tick in recording.ticks()] == list(range(400))
        assert len(list(recording.images())) == 3
        for number in (0, 41, 399):
            state = recording.blackboard(number)["toy:image"]
            assert state.tick == number // 40 * 40
            assert np.array_equal(decode(state.value, recording), images[number // 40 % 3])


def test_each_part_opens_alone_in_any_viewer_and_begins_with_a_keyframe(tmp_path):
    write_parts(tmp_path / "a.mcap")
    first = 0
    for path in parts_of(tmp_path / "a.mcap"):
        with path.open("rb") as file:
            messages = list(make_reader(file).iter_messages())
        topics = [channel.topic for _, channel, _ in messages]
        ticks = [json.loads(m.data) for _, channel, m in messages if channel.topic == "/ticks"]
        assert topics.count("/mission") == 1
        assert ticks[0]["tick"] == first
        assert "keyframe" in ticks[0]
        first += len(ticks)
    assert first == 400


def test_a_new_recording_leaves_no_part_of_an_older_one(tmp_path):
    write_parts(tmp_path / "a.mcap")
    for packed in ("a.mcap.packing", "a.part2.mcap.packing"):  # as a kill leaves them
        (tmp_path / packed).touch()
    write_parts(tmp_path / "a.mcap", ticks=10)
    assert len(Recording.open(tmp_path / "a.mcap")) == 10
    assert len(list(tmp_path.iterdir())) == len(parts_of(tmp_path / "a.mcap")) == 1


def test_a_lost_part_ends_the_recording_there(tmp_path):
    write_parts(tmp_path / "a.mcap")
    parts_of(tmp_path / "a.mcap")[1].write_bytes(b"")
    recording = Recording.open(tmp_path / "a.mcap")
    assert not recording.complete
    assert 0 < len(recording) < 400


def test_a_damaged_tick_of_an_unfinished_file_is_an_error_that_says_so(tmp_path):
    path = tmp_path / "live.mcap"
    writer = RecordingWriter(path, HEADER)
    writer.on_tick(tick_of(0))
    broken = path.read_bytes().replace(b'"time_s"', b'"time_z"')
    writer.close()
    path.write_bytes(broken)
    with pytest.raises(RecordingError, match="a damaged tick 0"):
        Recording.open(path).tick(0)


indices = st.integers(0, 5)
reasons = st.builds(
    Reason,
    st.text(),
    st.text(),
    st.dictionaries(st.text(), st.floats(allow_nan=False, allow_infinity=False)),
)
ticks = st.builds(
    Tick,
    st.integers(0, 600),
    st.floats(0.0, 1e6),
    st.floats(0.0, 1.0),
    visited=st.lists(indices, max_size=6).map(tuple),
    changes=st.lists(st.tuples(indices, st.sampled_from(NodeStatus)), max_size=4).map(tuple),
    halts=st.lists(st.builds(Halt, indices, st.integers(-1, 5)), max_size=2).map(tuple),
    outcomes=st.lists(
        st.builds(NodeOutcome, indices, st.sampled_from(NodeStatus), st.none() | reasons),
        max_size=3,
    ).map(tuple),
    writes=st.lists(
        st.builds(Write, st.text(), st.none() | st.booleans() | st.text(), st.text()), max_size=3
    ).map(tuple),
    faults=st.lists(
        st.builds(NodeFault, st.text(), st.text(), st.text(), st.text()), max_size=1
    ).map(tuple),
    slow=st.lists(
        st.builds(SlowStep, indices, st.floats(0.0, 1.0), st.floats(0.0, 1.0)), max_size=1
    ).map(tuple),
)


@settings(max_examples=50, deadline=None)
@given(ticks)
def test_the_json_of_a_tick_is_what_its_model_reads(tick):
    large = LargeValues(lambda *_: None, 30.0)
    encoder = TickEncoder(6, ValueEncoder(large.image, large.array), large)
    message = TickMessage.model_validate_json(encoder.encode(tick))
    assert message.visited == tick.visited
    fields = ("time_s", "duration_s", "changes", "halts", "outcomes", "writes", "faults", "slow")
    assert message.tick == tick.number
    for name in fields:
        assert getattr(message, name) == getattr(tick, name)
    assert (message.keyframe is None) == (tick.number % 256 != 0)
