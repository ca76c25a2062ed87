"""What the benchmark of faults breaks: a mission of seconds, a campaign of it, their processes."""

import os
import resource
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from executive.core.errors import RecordingError
from executive.engine.recording.reader import Recording

REFUSED, BROKEN = 2, 3
"""Exit codes: what was given cannot be used; something broke."""

STUBS = """
format: 1
stubs: work_stubs
skills:
  look:
    out: {part: {type: str}}
    outcomes: [{outcome: success, ticks: 3, out: {part: bolt}}]
  move:
    in: {part: {type: str}}
    acts: true
    outcomes: [{outcome: success, ticks: 6}]
"""
MISSION = """
format: 1
mission: work
cell: dry
uses: [work_stubs]
timeout_s: 100000.0
in:
  parts: {type: int, default: 400}
  note: {type: str, default: ""}
root:
  repeat:
    times: $parts
    child:
      sequence:
        name: one
        children:
          - {skill: look, checkpoint: true, out: {part: $part}}
          - {skill: move, in: {part: $part}}
"""
CAMPAIGN = """
campaign: works
format: 1
mission: work
set: {parts: 10}
seeds: {count: 24}
"""


def write_work(folder: Path) -> None:
    """Write the mission, its stubs, and a campaign of it."""
    for name, text in (("work_stubs", STUBS), ("work", MISSION), ("works", CAMPAIGN)):
        (folder / f"{name}.yaml").write_text(text, encoding="utf-8")


def write_campaign(folder: Path, settings: str) -> None:
    """Write the campaign anew, with other settings of the mission."""
    text = CAMPAIGN.replace("{parts: 10}", settings)
    (folder / "works.yaml").write_text(text, encoding="utf-8")


def command(*words: object) -> list[str]:
    """Return a command line of Cellwright."""
    return [str(Path(sys.executable).with_name("cellwright")), *map(str, words)]


def call(
    folder: Path, *words: object, most_bytes: int | None = None
) -> "subprocess.CompletedProcess[str]":
    """Run Cellwright in a folder; no file may grow beyond a size, as on a disk that is full."""

    def limit() -> None:
        assert most_bytes is not None
        resource.setrlimit(resource.RLIMIT_FSIZE, (most_bytes, most_bytes))

    return subprocess.run(
        command(*words),
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        env=environment(),
        preexec_fn=limit if most_bytes is not None else None,
    )


def environment() -> dict[str, str]:
    """Return the environment of a run: one thread of the linear algebra libraries."""
    return {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


def started(folder: Path, *words: object) -> subprocess.Popen[bytes]:
    """Start Cellwright in a folder and return its process; what it prints is dropped."""
    return subprocess.Popen(
        command(*words),
        cwd=folder,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=environment(),
    )


def killed_when(folder: Path, words: Sequence[object], due: Callable[[], bool]) -> bool:
    """Run Cellwright and kill it (`kill -9`) when it is due; return whether it still ran."""
    with started(folder, *words) as process:
        while process.poll() is None and not due():
            time.sleep(0.005)
        ran = process.poll() is None
        process.kill()
    return ran


def readable_ticks(file: Path) -> int:
    """Return how many ticks a recording holds; 0 for one that has not begun."""
    try:
        return len(Recording.open(file))
    except (RecordingError, FileNotFoundError):
        return 0
