"""The untangling mission on fresh seeds: the thesis's Table 4.2, by tier and policy.

Each run is a process of its own, as an engineer would start it. Recordings and what each run came
to are kept in a folder, and a benchmark that was killed goes on with what is not there yet.
Failures of kinds 1 to 7 are those of the thesis (section 4.3), told from truth and recording.
"""

import argparse
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

from benchmarks.harness import Row, median, share
from benchmarks.untangle_trial import KNOTS, Trial, Wanted, left_to_run, read_trials, tried
from benchmarks.untangle_truth import Failure
from simulation.cable.knot_names import KNOT_NAMES, TIER_NAMES
from skills.cable.policies import POLICY_NAMES, VISION_NAMES

CABLES = (*TIER_NAMES, *KNOT_NAMES)
RUNS = 30
QUICK_RUNS = 1
KEPT = Path("runs/untangle")
MINUTE_S = 60.0


def run(quick: bool, seed: int, words: Sequence[str] = ()) -> Sequence[Row]:
    """Run 30 cables of each tier (one when quick), seeds `seed` and up."""
    options = _options(words, quick)
    wanted = [
        Wanted(cable=cable, seed=seed + k, policy=policy, vision=options.vision)
        for k in range(options.runs)
        for policy in options.policy
        for cable in options.tier
    ]
    return rows(run_all(wanted, options.out, options.processes, MINUTE_S * options.minutes))


def _options(words: Sequence[str], quick: bool) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks untangle")
    parser.add_argument("--tier", nargs="+", choices=CABLES, default=list(TIER_NAMES))
    parser.add_argument("--policy", nargs="+", choices=POLICY_NAMES, default=["default"])
    parser.add_argument("--vision", choices=("default", *VISION_NAMES), default="default")
    parser.add_argument("--runs", type=int, default=QUICK_RUNS if quick else RUNS)
    parser.add_argument("--processes", type=int, choices=(1, 2), default=1)
    parser.add_argument(
        "--minutes", type=float, default=float("inf"), help="start no further run after so many"
    )
    parser.add_argument("--out", type=Path, default=KEPT, help="recordings and partial results")
    return parser.parse_args([*words])


def run_all(
    wanted: Sequence[Wanted], folder: Path, processes: int, longest_s: float = float("inf")
) -> list[Trial]:
    """Run what has not been run yet, and return all trials that are wanted and there.

    Args:
        wanted: What to run.
        folder: Where recordings, and results as they come, are kept.
        processes: How many missions run side by side.
        longest_s: No further run is started after this time.
    """
    ends_s = time.monotonic() + longest_s
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "trials.jsonl"
    done = read_trials(file)
    # What a kill has cut short goes.
    file.write_text("".join(f"{trial.model_dump_json()}\n" for trial in done), encoding="utf-8")
    with ThreadPoolExecutor(processes) as pool, file.open("a", encoding="utf-8") as kept:
        futures = [pool.submit(_in_time, one, folder, ends_s) for one in left_to_run(wanted, done)]
        for future in as_completed(futures):
            trial = future.result()
            if trial is None:
                continue
            done.append(trial)
            kept.write(trial.model_dump_json() + "\n")
            kept.flush()
            print(told(trial), file=sys.stderr, flush=True)
    return [trial for trial in done if trial.wanted in set(wanted)]


def _in_time(wanted: Wanted, folder: Path, ends_s: float) -> Trial | None:
    """Run a mission unless the time is over."""
    return tried(wanted, folder) if time.monotonic() < ends_s else None


def told(trial: Trial) -> str:
    """Return a line about a run."""
    wanted = trial.wanted
    verdict = "verified" if trial.verified else "untangled" if trial.untangled else "knotted"
    why = f", ({trial.failure.value}) {trial.failure.name}" if trial.failure is not None else ""
    return (
        f"{wanted.cable} {wanted.policy} {wanted.vision} {wanted.seed}: {verdict}{why} after "
        f"{trial.sim_s:.0f} s ({trial.wall_s:.0f} s here), {trial.actions} actions"
    )


def rows(trials: Sequence[Trial]) -> list[Row]:
    """Return the figures of each sort of cable and policy, then those of each policy's runs."""
    sorts = sorted({(t.wanted.policy, t.wanted.cable) for t in trials})
    found: list[Row] = []
    for policy, cable in sorts:
        mine = [t for t in trials if (t.wanted.policy, t.wanted.cable) == (policy, cable)]
        found += _of_sort(cable if policy == "default" else f"{cable}_{policy}", mine)
    for policy in sorted({policy for policy, _ in sorts}):
        found += _of_policy(policy, [t for t in trials if t.wanted.policy == policy])
    return found


def _of_sort(name: str, trials: Sequence[Trial]) -> list[Row]:
    """Return the columns of Table 4.2 for one sort of cable."""
    n, knots = len(trials), KNOTS.get(trials[0].wanted.cable, 1)
    untangled, verified = sum(t.untangled for t in trials), [t for t in trials if t.verified]
    goal = ">= 0.95" if trials[0].wanted.policy == "default" else ""
    found = []
    for knot in range(knots):
        times_s = [t.undone_s[knot] for t in trials if len(t.undone_s) > knot]
        found.append(share(f"{name}_knot_{knot + 1}", len(times_s), n))
        found += _minutes(f"{name}_knot_{knot + 1}_min", times_s)
    found.append(share(f"{name}_untangled_and_verified", len(verified), n, goal))
    found += [share(f"{name}_verified", len(verified), untangled)] if untangled else []
    found += _minutes(f"{name}_verified_min", [t.sim_s for t in verified])
    for kind in Failure:
        count = sum(t.failure is kind for t in trials)
        found += [share(f"{name}_failure_{kind.value}", count, n)] if count else []
    return found


def _minutes(name: str, times_s: Sequence[float]) -> list[Row]:
    return [median(name, [s / MINUTE_S for s in times_s], "min")] if times_s else []


def _of_policy(policy: str, trials: Sequence[Trial]) -> list[Row]:
    """Return what holds for all cables that were untangled in one way."""
    n, samples = len(trials), sum(t.samples for t in trials)
    ours, name = policy == "default", "" if policy == "default" else f"{policy}_"
    known = [(t.sim_s, t.cpu_s) for t in trials if t.cpu_s is not None]
    rest_s = [t.wall_s - t.seeing_s - t.thinking_s - t.acting_s for t in trials]
    found = [
        share(f"{name}verified", sum(t.verified for t in trials), n, ">= 0.95" if ours else ""),
        share(
            f"{name}false_claims",
            sum(t.claimed and not t.untangled for t in trials),
            n,
            "= 0" if ours else "",
        ),
        share(f"{name}limits_broken", sum(t.broken for t in trials), samples, "= 0"),
        share(f"{name}bodies_touching", sum(t.touching for t in trials), samples, "= 0"),
        median(f"{name}actions", [t.actions for t in trials], "1"),
        median(f"{name}wall_s", [t.wall_s for t in trials], "s"),
        median(
            f"{name}sim_to_wall", [t.sim_s / t.wall_s for t in trials], "1", ">= 3" if ours else ""
        ),
        median(f"{name}seeing_s", [t.seeing_s for t in trials], "s"),
        median(f"{name}thinking_s", [t.thinking_s for t in trials], "s"),
        median(f"{name}acting_s", [t.acting_s for t in trials], "s"),
        median(f"{name}physics_and_opening_s", rest_s, "s"),
    ]
    if known:
        ratios = [sim_s / cpu_s for sim_s, cpu_s in known]
        found += [
            median(f"{name}cpu_s", [cpu_s for _, cpu_s in known], "s"),
            median(f"{name}robot_over_cpu", ratios, "1", ">= 3" if ours else ""),
        ]
    return found
