"""The untangling mission as it ships, on fresh seeds: claims held against the truth.

Each run is a process of its own, as an engineer would start it. `claimed and true` counts;
a false claim counts as a failure and is listed on its own.
"""

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from benchmarks.harness import Row, median, share

KNOTS = ("overhand", "figure_8")
MISSION = Path(__file__).parent.parent / "trees" / "missions" / "untangle.yaml"


@dataclass(frozen=True, slots=True)
class Trial:
    """One run of the mission.

    Attributes:
        knot: What was tied.
        claimed: Whether the mission said untangled.
        true: Whether that was so.
        sim_s: Time on the robot's clock.
        wall_s: Time it took.
        actions: How often the arms acted on the cable.
    """

    knot: str
    claimed: bool
    true: bool
    sim_s: float
    wall_s: float
    actions: int


def run(quick: bool, seed: int) -> Sequence[Row]:
    """Run both knots, seeds `seed` to `seed + 9` each (two each when quick)."""
    seeds = range(seed, seed + (2 if quick else 10))
    wanted = [(knot, number) for knot in KNOTS for number in seeds]
    with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
        trials = list(pool.map(lambda one: trial(*one), wanted))
    return rows(trials)


def trial(knot: str, seed: int) -> Trial:
    """Run the mission once in a process of its own."""
    with tempfile.TemporaryDirectory() as folder:
        command = [str(Path(sys.executable).with_name("cellwright")), "run", str(MISSION), "--json"]
        command += ["--seed", str(seed), "--set", f"cable.knot={knot}"]
        command += ["--record", str(Path(folder) / "run.mcap")]
        environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        answer = subprocess.run(command, capture_output=True, text=True, env=environment)
    if answer.returncode not in (0, 1):
        raise RuntimeError(f"{knot} {seed}: exit code {answer.returncode}\n{answer.stderr[-2000:]}")
    result = _read(knot, json.loads(answer.stdout))
    print(f"{knot} {seed}: {result}", file=sys.stderr, flush=True)
    return result


def _read(knot: str, report: Mapping[str, object]) -> Trial:
    claim, truth, actions = report["claim"], report["truth"], report["actions"]
    assert isinstance(claim, dict)
    assert isinstance(truth, dict)
    assert isinstance(actions, list)
    acted = [action for action in actions if action["name"] != "go_home"]
    times = float(str(report["sim_s"])), float(str(report["wall_s"]))
    return Trial(knot, bool(claim["untangled"]), bool(truth["untangled"]), *times, len(acted))


def rows(trials: Sequence[Trial]) -> list[Row]:
    """Return the figures of a set of runs."""
    done = [trial for trial in trials if trial.claimed and trial.true]
    found = [
        share("untied_with_true_claim", len(done), len(trials), ">= 0.7"),
        *(_of_knot(knot, trials) for knot in KNOTS),
        share("untied", sum(trial.true for trial in trials), len(trials)),
        share("false_claims", sum(t.claimed and not t.true for t in trials), len(trials), "= 0"),
        median("wall_s", [trial.wall_s for trial in trials], "s"),
        median("sim_to_wall", [trial.sim_s / trial.wall_s for trial in trials], "1"),
    ]
    if done:
        found += [
            median("sim_s_to_true_claim", [trial.sim_s for trial in done], "s"),
            median("actions_to_true_claim", [trial.actions for trial in done], "1"),
        ]
    return found


def _of_knot(knot: str, trials: Sequence[Trial]) -> Row:
    mine = [trial for trial in trials if trial.knot == knot]
    hits = sum(trial.claimed and trial.true for trial in mine)
    return share(f"{knot}_untied_with_true_claim", hits, len(mine))
