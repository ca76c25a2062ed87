"""Trials of one fault after another, kept as they come: a benchmark that was killed goes on."""

import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydantic import BaseModel, ConfigDict

from benchmarks.fault_missions import write_work
from benchmarks.harness import Row, share
from executive.engine.result_folders import ResultLines


@dataclass(frozen=True, slots=True)
class Answer:
    """What the cell answered to one fault.

    Attributes:
        held: Whether it did what it owes.
        did: What it did, in a few words.
        lost: Ticks or results that had been recorded and are not there any more.
    """

    held: bool
    did: str
    lost: int = 0


@dataclass(frozen=True, slots=True)
class Fault:
    """A fault that is injected a number of times.

    Attributes:
        name: Of its row.
        injected: What is done, in words.
        detected: How the cell comes to know, in words.
        count: How many times.
        inject: Injects it in an empty folder with the mission in it.
    """

    name: str
    injected: str
    detected: str
    count: int
    inject: Callable[[Path, np.random.Generator], Answer]


class Trial(BaseModel):
    """One line of the file of trials."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    fault: str
    number: int
    seed: int
    held: bool
    did: str
    lost: int


def tried(faults: Sequence[Fault], seed: int, folder: Path) -> list[Trial]:
    """Inject all faults, but those whose trial is in the folder already."""
    folder.mkdir(parents=True, exist_ok=True)
    lines = ResultLines(folder, Trial)
    lines.end_last_line()
    known = {(one.fault, one.number): one for one in lines if one.seed == seed}
    found = []
    for row, fault in enumerate(faults):
        for number in range(fault.count):
            trial = known.get((fault.name, number))
            if trial is None:
                rng = np.random.default_rng([seed, row, number])
                trial = _tried(fault, number, seed, rng)
                lines.add(trial)
            found.append(trial)
        print(f"{fault.name}: {_counted(found, fault)}", file=sys.stderr, flush=True)
    return found


def rows(faults: Sequence[Fault], trials: Sequence[Trial]) -> list[Row]:
    """Return the share of each fault that the cell was up to, and what was lost by all of them."""
    found = []
    for fault in faults:
        mine = [trial.held for trial in trials if trial.fault == fault.name]
        found.append(share(fault.name, sum(mine), len(mine), "= 1"))
    lost = [trial.lost for trial in trials]
    return [*found, Row("recorded_lost", sum(lost), "1", len(lost), min(lost), max(lost), "= 0")]


def table(faults: Sequence[Fault], trials: Sequence[Trial]) -> str:
    """Return the table of faults: injected, detected, what the cell did, what was lost."""
    lines = ["injected | detected | what the cell did | lost of what was recorded"]
    for fault in faults:
        lost = sum(trial.lost for trial in trials if trial.fault == fault.name)
        cells = (fault.injected, fault.detected, _counted(trials, fault), str(lost or "nothing"))
        lines.append(" | ".join(cells))
    return "\n".join(lines)


def _tried(fault: Fault, number: int, seed: int, rng: np.random.Generator) -> Trial:
    with tempfile.TemporaryDirectory() as name:
        write_work(Path(name))
        answer = fault.inject(Path(name), rng)
    return Trial(
        fault=fault.name,
        number=number,
        seed=seed,
        held=answer.held,
        did=answer.did,
        lost=answer.lost,
    )


def _counted(trials: Sequence[Trial], fault: Fault) -> str:
    """Say what the cell did, and how often."""
    mine = [trial for trial in trials if trial.fault == fault.name]
    counts = Counter(trial.did if trial.held else f"WRONG: {trial.did}" for trial in mine)
    return "; ".join(f"{did} ({count})" for did, count in counts.most_common())
