"""What may be loaded before a command needs it: nothing heavy."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

HEAVY = ("torch", "cv2", "pybullet", "pinocchio", "coal", "meshcat", "ruckig", "numba")
SCRIPT = """
import json, sys
from executive.cli.main import main
sys.argv = ["cellwright", *sys.argv[1:]]
try:
    main()
except SystemExit as end:
    code = end.code or 0
print(json.dumps([code, [name for name in {heavy!r} if name in sys.modules]]), file=sys.stderr)
"""
MISSION = Path(__file__).parents[3] / "trees" / "missions" / "untangle.yaml"


@pytest.mark.parametrize(
    "arguments",
    [
        ["--help"],
        ["--version"],
        ["run", "--help"],
        ["check", str(MISSION)],
        ["skills"],
        ["tree", "show", str(MISSION)],
        ["inspect", "--help"],
        ["perceive", "cable", "--help"],
        ["affinity", "--help"],
        ["affinity", "show", "pharmacy"],
        ["train", "--help"],
        ["doctor", "--help"],
    ],
)
def test_looking_at_things_loads_no_simulator_planner_or_network(arguments):
    ended = subprocess.run(
        [sys.executable, "-c", SCRIPT.format(heavy=HEAVY), *arguments],
        capture_output=True,
        text=True,
        check=False,
    )
    code, loaded = json.loads(ended.stderr.splitlines()[-1])
    assert (code, loaded) == (0, []), ended.stderr
    assert ended.stdout


def test_help_breaks_lines_where_they_are_shown():
    cellwright = Path(sys.executable).with_name("cellwright")
    told = subprocess.run(
        [cellwright, "run", "--help"],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "COLUMNS": "200"},
    ).stdout
    assert "a second one stops the arms at once. Ctrl-Z pauses the mission;" in told


def test_a_bug_of_ours_exits_with_3_not_with_1(monkeypatch, capsys):
    from executive.cli import main

    def broken():
        raise KeyError("surprise")

    monkeypatch.setattr(main, "app", broken)
    with pytest.raises(SystemExit) as end:
        main.main()
    assert end.value.code == 3
    assert "surprise" in capsys.readouterr().err
