"""The mission that ships, on the simulated cell, from YAML to claim and recording."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from executive.engine.recording.fingerprint import status_fingerprint
from executive.engine.recording.reader import Recording

CELLWRIGHT = str(Path(sys.executable).with_name("cellwright"))
pytestmark = pytest.mark.sim


def run(folder, name, *options):
    recording = folder / f"{name}.mcap"
    command = [CELLWRIGHT, "run", "untangle", "--json", "--record", str(recording), *options]
    answer = subprocess.run(command, capture_output=True, text=True, check=False)
    return answer.returncode, json.loads(answer.stdout), recording


def test_a_cable_without_a_knot_is_claimed_untangled_after_two_looks(tmp_path):
    code, report, recording = run(tmp_path, "none", "--set", "cable.knot=none", "--seed", "3")
    assert (code, report["outcome"]) == (0, "success")
    assert report["claim"]["untangled"] is True
    assert report["truth"]["untangled"] is True
    assert {action["name"] for action in report["actions"]} == {"go_home"}
    assert len(list(Recording.open(recording).images())) == 2


def test_the_same_seed_gives_the_same_recording_status_for_status(tmp_path):
    options = ("--seed", "4", "--timeout", "9")
    prints = [status_fingerprint(Recording.open(run(tmp_path, n, *options)[2])) for n in "ab"]
    assert prints[0] == prints[1]


def test_a_configuration_from_a_file_is_what_the_camera_sees(tmp_path):
    nodes = [[-0.35 + 0.7 * k / 100, 0.05, 0.0033] for k in range(101)]
    file = tmp_path / "straight.json"
    file.write_text(json.dumps({"nodes_m": nodes}), encoding="utf-8")
    code, report, _ = run(tmp_path, "file", "--set", f"cable.file={file}")
    assert (code, report["claim"]["untangled"], report["truth"]["crossings"]) == (0, True, 0)


def test_a_configuration_that_cannot_be_used_is_bad_input(tmp_path):
    file = tmp_path / "broken.json"
    file.write_text('{"nodes_m": [[0, 0, 0], [0, "x", 0]]}', encoding="utf-8")
    code, report, _ = run(tmp_path, "bad", "--set", f"cable.file={file}")
    assert (code, report["outcome"]) == (2, "error")
