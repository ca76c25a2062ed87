"""Whatever a kill leaves of a recording: it is gone on with from its last whole checkpoint."""

import random
from dataclasses import dataclass

import pytest
from killed_toys import resume, run, write_mission

from executive.core.errors import InputError, RecordingError
from executive.engine.checkpoints.choosing import checkpoints, chosen
from executive.engine.recording.fingerprint import status_fingerprint
from executive.engine.recording.reader import Recording
from executive.engine.recording.writer import RecordingWriter

MISSION = """
    retry:
      times: 9
      child:
        sequence:
          - {skill: draw, out: {drawn: $drawn}}
          - {skill: work, checkpoint: true, in: {label: a, ticks: 2}, out: {part: $part}}
          - {skill: work, name: b, in: {label: b, fails: 4, ticks: 2}}
    """


@dataclass(frozen=True)
class Killed:
    """A finished recording, and its file as it was while it was written.

    Attributes:
        whole: The finished recording.
        content: The file just before it was closed.
        sizes: Its size after each checkpoint.
    """

    whole: Recording
    content: bytes
    sizes: tuple[int, ...]


@pytest.fixture
def killed(tmp_path, monkeypatch):
    """Run a mission, and look at its recording on the way."""
    sizes, contents = [], []
    write_now, close = RecordingWriter.write_now, RecordingWriter.close

    def measured(writer, topic, message, time_s, number):
        write_now(writer, topic, message, time_s, number)
        sizes.append(writer.path.stat().st_size)

    def kept(writer):
        contents.append(writer.path.read_bytes())
        close(writer)

    monkeypatch.setattr(RecordingWriter, "write_now", measured)
    monkeypatch.setattr(RecordingWriter, "close", kept)
    whole, _ = run(write_mission(tmp_path, MISSION), tmp_path / "whole.mcap")
    monkeypatch.undo()
    return Killed(whole, contents[0], tuple(sizes))


def cut(killed, size, path):
    """Write what a kill would have left when the file had that size."""
    path.write_bytes(killed.content[:size])
    return path


def found_in(path):
    """Return the number of the checkpoint to go on from, and why there is none."""
    try:
        return chosen(Recording.open(path)).message.number, ""
    except (InputError, RecordingError) as error:
        return -1, str(error)


def test_every_length_has_its_last_whole_checkpoint_or_says_why_there_is_none(killed, tmp_path):
    whole, sizes = killed.whole, killed.sizes
    assert len(sizes) == len(checkpoints(whole)) >= 5
    end = len(killed.content)
    moments = {0, 1, end - 1, *(size + off for size in sizes for off in (-1, 0, 1))}
    moments |= set(random.Random(5).sample(range(end), 60))
    for size in sorted(moments):
        path = cut(killed, size, tmp_path / "cut.mcap")
        expected = sum(each <= size for each in sizes) - 1
        number, refusal = found_in(path)
        if expected < 0:
            assert "no checkpoint yet" in refusal or "not a readable recording" in refusal, size
        elif "has ended with" not in refusal:
            assert number == expected, (size, refusal)


def test_no_tick_that_was_recorded_before_a_checkpoint_is_lost(killed, tmp_path):
    whole, sizes = killed.whole, killed.sizes
    for info, size in zip(checkpoints(whole), sizes, strict=True):
        left = Recording.open(cut(killed, size, tmp_path / "cut.mcap"))
        assert len(left) == info.message.progress.tick
        assert [left.tick(i) for i in range(len(left))] == [whole.tick(i) for i in range(len(left))]


def test_what_a_kill_leaves_leads_to_the_same_end(killed, tmp_path):
    whole, sizes = killed.whole, killed.sizes
    cuts = random.Random(7).sample(range(sizes[0], sizes[-1] + 500), 5)
    for size in cuts:
        path = cut(killed, size, tmp_path / "cut.mcap")
        again, _ = resume(path, tmp_path / "again.mcap")
        assert status_fingerprint(again) == status_fingerprint(whole), size


def test_damage_inside_a_recording_is_never_more_than_an_explanation(killed, tmp_path):
    chance = random.Random(3)
    contents = killed.content, killed.whole.path.read_bytes()
    for i in range(40):
        damaged = bytearray(contents[i % 2])
        for _ in range(chance.randrange(1, 20)):
            damaged[chance.randrange(len(damaged))] = chance.randrange(256)
        path = tmp_path / "damaged.mcap"
        path.write_bytes(bytes(damaged[: chance.randrange(len(damaged))]))
        number, refusal = found_in(path)
        assert (number >= 0) != bool(refusal)


def test_a_file_that_is_no_recording_is_none(tmp_path):
    (tmp_path / "x.mcap").write_bytes(b"some other file")
    with pytest.raises(RecordingError, match="not a readable recording"):
        Recording.open(tmp_path / "x.mcap")
