"""A recording that is followed while it grows is the one that is read at the end."""

import pytest
from toy_runs import built, busy_tree, header_of, record

from executive.engine.recording.growing import GrowingRecording
from executive.engine.recording.reader import Recording
from executive.engine.recording.writer import RecordingWriter


@pytest.fixture(scope="module")
def ticks(tmp_path_factory):
    _, seen = record(tmp_path_factory.mktemp("run") / "run.mcap", busy_tree())
    return seen


def same(one, other):
    assert len(one) == len(other)
    for number in range(0, len(one), 37):
        assert one.tick(number) == other.tick(number)
        assert one.statuses(number) == other.statuses(number)


@pytest.mark.parametrize("part_bytes", [10**9, 20_000])
def test_every_tick_is_there_once_it_has_been_written(tmp_path, ticks, part_bytes):
    path = tmp_path / "run.mcap"
    header = header_of(built(busy_tree()))
    with RecordingWriter(path, header, part_bytes=part_bytes) as writer:
        growing = GrowingRecording(path)
        assert len(growing.recording) == 0
        for number, tick in enumerate(ticks):
            writer.on_tick(tick)
            if tick.changes and number % 50 == 0:
                growing.refresh()
                same(growing.recording, Recording.open(path))
                assert not growing.refresh()
    assert growing.refresh()
    same(growing.recording, Recording.open(path))
    assert growing.recording.complete


def test_half_a_message_is_waited_for(tmp_path, ticks):
    whole, path = tmp_path / "whole.mcap", tmp_path / "run.mcap"
    writer = RecordingWriter(whole, header_of(built(busy_tree())))
    for tick in ticks[:50]:
        writer.on_tick(tick)
    data = whole.read_bytes()
    path.write_bytes(data[:-3])
    growing = GrowingRecording(path)
    before = len(growing.recording)
    with path.open("ab") as file:
        file.write(data[-3:])
    growing.refresh()
    assert before < len(growing.recording) == len(Recording.open(path))
    writer.close()
