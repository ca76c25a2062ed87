"""One run of the untangling mission in a process of its own, and what its recording tells."""

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from pydantic import BaseModel, ConfigDict

from benchmarks.untangle_truth import (
    Failure,
    cable_moments,
    executed_motion,
    failure_of,
    knots_left,
    undone_s,
)
from executive.engine.recording.messages import RunReport
from executive.engine.recording.reader import Recording
from executive.inspector.index import RunIndex
from executive.inspector.times import node_times

# Who is killed after so much time here has hung.
LONGEST_S = 10_800.0
# Exit codes of missions that were run: success, failure, error.
RAN = (0, 1, 3)
# The mission as from the command line; says at last what it has cost of processors' time.
MISSION = """
import sys, time
from executive.cli.main import main
try:
    main()
finally:
    print(f"\\n{time.process_time()}", file=sys.stderr)
"""
# How long the cables of tiers and of single knots are, which an engineer knows [m].
LENGTHS_M = {"tier": 3.0, "knot": 1.5}
# How many knots the cables of a sort have; one with a knot by name has one.
KNOTS = {"C3": 2}
# Skills by what they take their time for.
SEEING = ("observe_workspace", "detect_endpoints", "find_start_points", "trace_cable")
THINKING = ("classify_crossings", "orient_trace", "find_knots", "account_for_cable")


class Wanted(BaseModel):
    """What to run.

    Attributes:
        cable: A tier, or the name of a knot.
        seed: Seed of everything random.
        policy: Value of the mission's input, `default` for the mission's own.
        vision: The same.
        options: Further `--set` options.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    cable: str
    seed: int
    policy: str = "default"
    vision: str = "default"
    options: tuple[str, ...] = ()

    def name(self) -> str:
        """Return a name for files."""
        words = (self.cable, self.policy, self.vision, *self.options, f"{self.seed}")
        return "_".join(word.replace("=", "-").replace("/", "-") for word in words)

    def settings(self) -> list[str]:
        """Return `--set` options."""
        sort = "tier" if self.cable.startswith("C") else "knot"
        found = [f"cable.{sort}={self.cable}", f"length_m={LENGTHS_M[sort]}", *self.options]
        for key in ("policy", "vision"):
            value = getattr(self, key)
            found += [f"{key}={value}"] if value != "default" else []
        return [part for setting in found for part in ("--set", setting)]


class Trial(BaseModel):
    """How one run went.

    Attributes:
        wanted: What was run.
        outcome: How the mission ended.
        reason: Why, in one line.
        claimed: Whether it said untangled.
        untangled: Whether that is so.
        undone_s: When the first, the second knot was undone, on the robot's clock.
        sim_s: Time on the robot's clock.
        wall_s: Time it took here.
        seeing_s: Of that, what looking and tracing took.
        thinking_s: Of that, what crossings and knots took.
        acting_s: Of that, what skills that move arms took; the rest is physics and opening.
        actions: How often the arms acted on the cable.
        failure: Why the cable was not untangled; None where it is.
        samples: Moments at which joints were looked at.
        broken: Of these, with a joint beyond a limit.
        touching: Of these, with two bodies that touch.
        cpu_s: What the process cost of processors' time from its start on; None where not known.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    wanted: Wanted
    outcome: str
    reason: str
    claimed: bool
    untangled: bool
    undone_s: tuple[float, ...]
    sim_s: float
    wall_s: float
    seeing_s: float
    thinking_s: float
    acting_s: float
    actions: int
    failure: Failure | None
    samples: int
    broken: int
    touching: int
    cpu_s: float | None = None

    @property
    def verified(self) -> bool:
        """Whether it was untangled and said so."""
        return self.claimed and self.untangled


def tried(wanted: Wanted, folder: Path) -> Trial:
    """Run a mission and read its recording, which stays in the folder.

    Raises:
        RuntimeError: The mission could not be run; with what it said.
    """
    file = folder / f"{wanted.name()}.mcap"
    command = [sys.executable, "-c", MISSION]
    command += ["run", "untangle", "--json", "--overwrite", "--record", str(file)]
    command += ["--seed", str(wanted.seed), *wanted.settings()]
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    answer = subprocess.run(
        command, capture_output=True, text=True, env=environment, timeout=LONGEST_S, check=False
    )
    if answer.returncode not in RAN:
        told = answer.stderr[-2000:] or answer.stdout[-2000:]
        raise RuntimeError(f"{wanted.name()}: exit code {answer.returncode}\n{told}")
    report, cpu_s = RunReport.model_validate_json(answer.stdout), answer.stderr.split()[-1]
    trial = trial_of(wanted, report, Recording.open(file))
    return trial.model_copy(update={"cpu_s": float(cpu_s)})


def trial_of(wanted: Wanted, report: RunReport, recording: Recording) -> Trial:
    """Return what a recorded run came to, held against the truth."""
    acted = [action for action in report.actions if action.name != "go_home"]
    moments = cable_moments(recording, [a.start_s + a.duration_s for a in acted])
    at_first = KNOTS.get(wanted.cable, 1)
    untangled = knots_left(moments.nodes_m[-1], at_first) == 0
    seeing_s, thinking_s, acting_s = _computing_s(recording)
    motion = executed_motion(recording)
    return Trial(
        wanted=wanted,
        outcome=report.outcome,
        reason=report.reason,
        claimed=isinstance(report.claim, dict) and bool(report.claim["untangled"]),
        untangled=untangled,
        undone_s=undone_s(moments, at_first),
        sim_s=report.sim_s,
        wall_s=report.wall_s,
        seeing_s=seeing_s,
        thinking_s=thinking_s,
        acting_s=acting_s,
        actions=len(acted),
        failure=failure_of(report, untangled, moments),
        samples=motion.samples,
        broken=motion.broken,
        touching=motion.touching,
    )


def _computing_s(recording: Recording) -> tuple[float, float, float]:
    """Return what seeing, thinking and acting took on the machine's clock."""
    index = RunIndex.of(recording)
    groups = [0.0, 0.0, 0.0]
    for times in node_times(index):
        node = index.nodes[times.node]
        group = 0 if node.type in SEEING else 1 if node.type in THINKING else 2
        groups[group if node.acts else min(group, 1)] += times.compute_s
    return groups[0], groups[1], groups[2]


def read_trials(file: Path) -> list[Trial]:
    """Return the trials that an earlier call has left; a line that was cut short is left out."""
    if not file.exists():
        return []
    lines = file.read_text(encoding="utf-8").splitlines()
    return [Trial.model_validate_json(line) for line in lines if _is_whole(line)]


def _is_whole(line: str) -> bool:
    try:
        json.loads(line)
    except ValueError:
        return False
    return True


def left_to_run(wanted: Sequence[Wanted], done: Sequence[Trial]) -> list[Wanted]:
    """Return what no trial is there of yet."""
    there = {trial.wanted for trial in done}
    return [one for one in wanted if one not in there]
