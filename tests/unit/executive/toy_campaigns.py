"""A dry mission for campaigns, with a skill that can be told to hang, to die, or to eat memory."""

import os
import subprocess
import sys
from pathlib import Path

SKILL = '''
import os
import signal
import subprocess
import threading
import time
from executive.core.outcome import failure, success
from executive.core.skill import Port, Skill, SkillRun


class MayBreak(Skill):
    """Do as told."""

    OUT = {"claim": Port(float)}
    REASONS = ("toy.told_to",)

    def run(self, way: str, level: float) -> SkillRun:
        """Break in one way or another."""
        yield
        if way == "fail":
            return failure("toy.told_to", "as it was told")
        if way == "raise":
            raise ValueError("as it was told")
        if way == "die":
            os.kill(os.getpid(), signal.SIGKILL)
        if way == "slow":
            time.sleep(1.0)
        while way == "long":
            time.sleep(0.01)
            yield
        while way == "hang":
            time.sleep(0.05)
        if way == "thread":
            threading.Thread(target=time.sleep, args=(1e6,), daemon=True).start()
        if way == "child":
            subprocess.Popen(["sleep", "1000"])
        if way in ("neat", "thread", "child"):
            return success(claim=float(os.getppid()))
        hoard = []
        while way == "hoard":
            hoard.append(bytearray(b"x" * 50_000_000))
            time.sleep(0.1)
        return success(claim=level)
'''
MISSION = """
format: 1
mission: toy
cell: CELL
timeout_s: 3000.0
in:
  way: {type: str, default: well}
  level: {type: float, default: 0.5}
out:
  claim: {type: float}
root: {skill: may_break, in: {way: $way, level: $level}, out: {claim: $claim}}
"""


def write_toy(folder: Path, cell: str = "dry") -> dict[str, str]:
    """Write the mission and its skill, and return the environment in which they are found."""
    if cell != "dry":
        (folder / f"{cell}.yaml").write_text(f"format: 1\ncell: {cell}\nworld: dry\n")
    (folder / "toy_breaking.py").write_text(SKILL)
    (folder / "toy.yaml").write_text(MISSION.replace("CELL", cell))
    info = folder / "toy_breaking-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: toy-breaking\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(
        "[cellwright.skills]\nmay_break = toy_breaking:MayBreak\n"
    )
    return {**os.environ, "PYTHONPATH": str(folder), "OMP_NUM_THREADS": "1"}


def write_campaign(folder: Path, text: str) -> Path:
    """Write the document of a campaign of that mission."""
    file = folder / "campaign.yaml"
    file.write_text(f"campaign: trial\nformat: 1\nmission: toy\n{text}")
    return file


def cellwright(folder: Path, environment: dict[str, str], *arguments: object):
    """Call the command line in a process of its own, as a user would."""
    command = [str(Path(sys.executable).with_name("cellwright")), *map(str, arguments)]
    return subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
