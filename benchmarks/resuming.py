"""Untangling missions that are killed (`kill -9`) at random moments, and gone on with.

Each seed is run three times, each in a process of its own: without interruption, until it is
killed, and from the recording that the killed one has left. A mission that cannot be gone on
with must say why: one that is killed before its first checkpoint, at the most.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.harness import Row, median, share
from executive.core.errors import RecordingError
from executive.engine.recording.fingerprint import status_fingerprint
from executive.engine.recording.reader import Recording

KNOTS = ("overhand", "figure_8")
_REFUSED = 2


@dataclass(frozen=True, slots=True)
class Trial:
    """One killed mission.

    Attributes:
        resumed: Whether it was gone on with.
        refusal: Why not.
        lost_ticks: Ticks that could be read before the kill and not after it.
        redone_ticks: Ticks between the checkpoint and the kill.
        same_ticks: Whether the whole recording says what that of the uninterrupted run says.
        same_end: Whether outcome, claim and truth are those of the uninterrupted run.
    """

    resumed: bool
    refusal: str
    lost_ticks: int
    redone_ticks: int
    same_ticks: bool
    same_end: bool


def run(quick: bool, seed: int) -> Sequence[Row]:
    """Kill 20 missions of at most 60 s on the robot's clock (5 of at most 20 s when quick)."""
    kills, timeout_s = (5, 20.0) if quick else (20, 60.0)
    rng = np.random.default_rng(seed)
    return rows([trial(seed + i, timeout_s, float(rng.uniform())) for i in range(kills)])


def trial(seed: int, timeout_s: float, moment: float) -> Trial:
    """Kill one mission after a share `moment` of its ticks, and go on with it."""
    with tempfile.TemporaryDirectory() as folder:
        whole, killed, resumed = (Path(folder) / f"{name}.mcap" for name in "abc")
        knot = KNOTS[seed % len(KNOTS)]
        options = ["--seed", str(seed), "--set", f"cable.knot={knot}", "--timeout", str(timeout_s)]
        reference = _finished(["run", "untangle", *options], whole)
        ticks = int(str(reference["ticks"]))
        seen = _kill(["run", "untangle", *options], killed, round(moment * ticks))
        left = len(Recording.open(killed))
        answer = _call(["resume", str(killed), "--json", "--record", str(resumed)])
        if answer.returncode == _REFUSED:
            refusal = str(json.loads(answer.stdout)["reason"])
            result = Trial(False, refusal, max(0, seen - left), 0, False, False)
        else:
            report, again = _read(answer), Recording.open(resumed)
            assert again.header.resumed_from is not None
            result = Trial(
                resumed=True,
                refusal="",
                lost_ticks=max(0, seen - left),
                redone_ticks=left - again.header.resumed_from.tick,
                same_ticks=status_fingerprint(again) == status_fingerprint(Recording.open(whole)),
                same_end=all(
                    report[key] == reference[key] for key in ("outcome", "claim", "truth", "ticks")
                ),
            )
    print(f"{seed}: killed at tick {seen} of {ticks}: {result}", file=sys.stderr, flush=True)
    return result


def _kill(command: Sequence[str], recording: Path, tick: int) -> int:
    """Kill a mission once its recording holds that many ticks; return how many it held then."""
    with subprocess.Popen(
        [*_cellwright(), *command, "--record", str(recording)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=_environment(),
    ) as process:
        seen = 0
        while process.poll() is None:
            seen = _readable_ticks(recording)
            if seen >= tick:
                break
            time.sleep(0.05)
        process.kill()
    return seen


def _readable_ticks(recording: Path) -> int:
    try:
        return len(Recording.open(recording))
    except RecordingError:  # it has not been begun
        return 0


def _finished(command: Sequence[str], recording: Path) -> Mapping[str, object]:
    return _read(_call([*command, "--json", "--record", str(recording)]))


def _call(command: Sequence[str]) -> subprocess.CompletedProcess[str]:
    whole = [*_cellwright(), *command]
    return subprocess.run(whole, capture_output=True, text=True, env=_environment(), check=False)


def _read(answer: subprocess.CompletedProcess[str]) -> Mapping[str, object]:
    if answer.returncode not in (0, 1):
        raise RuntimeError(f"exit code {answer.returncode}\n{answer.stderr[-2000:]}")
    report: Mapping[str, object] = json.loads(answer.stdout)
    return report


def _cellwright() -> list[str]:
    return [str(Path(sys.executable).with_name("cellwright"))]


def _environment() -> Mapping[str, str]:
    return {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


def rows(trials: Sequence[Trial]) -> list[Row]:
    """Return the figures of a set of killed missions."""
    count, resumed = len(trials), [trial for trial in trials if trial.resumed]
    explained = sum(trial.resumed or bool(trial.refusal) for trial in trials)
    lost = [trial.lost_ticks for trial in trials]
    found = [
        share("resumed_or_explained", explained, count, "= 1"),
        share("resumed", len(resumed), count),
        Row("lost_ticks", sum(lost), "1", count, min(lost), max(lost), "= 0"),
    ]
    if resumed:
        found += [
            share("same_ticks", sum(trial.same_ticks for trial in resumed), len(resumed), "= 1"),
            share("same_end", sum(trial.same_end for trial in resumed), len(resumed), "= 1"),
            median("redone_ticks", [trial.redone_ticks for trial in resumed], "1"),
        ]
    return found
