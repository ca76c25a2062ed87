"""A mission that is killed (kill -9) goes on from what its recording holds, and ends the same."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from executive.core.errors import RecordingError
from executive.engine.checkpoints.choosing import checkpoints
from executive.engine.recording.fingerprint import status_fingerprint
from executive.engine.recording.reader import Recording

TOYS = Path(__file__).parent.parent / "unit" / "executive"
MISSION = """
format: 1
mission: toy
cell: toy_cell
scenario: {cable: {knot: overhand}, ending: success}
in:
  steps: {type: int, default: 12}
out:
  claim: {type: Claim}
root:
  sequence:
    children:
      - repeat:
          times: 8
          child: {skill: toy_move, checkpoint: true, in: {steps: $steps}}
      - {skill: toy_end, out: {claim: $claim}}
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "toy_cell.yaml").write_text("format: 1\ncell: toy_cell\nworld: toy\n")
    (tmp_path / "toy.yaml").write_text(MISSION)
    return tmp_path


def start(folder, *words):
    command = [sys.executable, str(TOYS / "toy_cellwright.py"), *words, "--json"]
    environment = {**os.environ, "PYTHONPATH": str(TOYS)}
    return subprocess.Popen(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment
    )


def report_of(process):
    output, errors = process.communicate(timeout=60)
    assert output, errors.decode()
    return json.loads(output)


def ticks_in(file):
    try:
        return len(Recording.open(file))
    except RecordingError:
        return 0


def test_a_killed_mission_ends_like_one_that_was_not(folder):
    whole = report_of(start(folder, "run", "toy.yaml", "--record", "whole.mcap"))
    process = start(folder, "run", "toy.yaml", "--record", "killed.mcap")
    deadline_s = time.monotonic() + 60.0
    while (seen := ticks_in(folder / "killed.mcap")) < 40 and time.monotonic() < deadline_s:
        time.sleep(0.01)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    killed = Recording.open(folder / "killed.mcap")
    assert killed.result is None
    assert len(killed) >= seen >= 40
    last = checkpoints(killed)[-1].message.progress.tick
    words = ("resume", "killed.mcap", "--record", "resumed.mcap", "--as-it-stands")
    resumed = report_of(start(folder, *words))
    for key in ("outcome", "claim", "truth", "ticks"):
        assert resumed[key] == whole[key]
    again = Recording.open(folder / "resumed.mcap")
    assert again.header.resumed_from.tick == last
    assert again.complete
    assert [again.tick(i) for i in range(last)] == [killed.tick(i) for i in range(last)]
    assert status_fingerprint(again) == status_fingerprint(Recording.open(folder / "whole.mcap"))
