"""Searches of shelves without a tree: the thesis's Tables 7.3 to 7.5, and what could be.

Each method searches the same scenes: three domains, four numbers of objects, with pushes and
suction on objects scaled as the thesis has it, and with pushes alone on objects of full size, whose
tool needs no room beside an object, as simulators of first order have it. `rand` is no order.

`solvable` is the share of scenes that may be solved at all; success is given among these, too.
Actions are those over scenes that both methods have solved, `capped` counts a failed search as the
most that are allowed, 2 N. Intervals of changes are bootstrapped over paired scenes.

The environment may say how many scenes there are of each kind (`SEARCH_SCENES`, 200) and how many
processes work on them (`SEARCH_WORKERS`, one for each core). With `--kept FILE` each scene is
written down when all have searched it, and a benchmark that was killed goes on from there: scene by
scene of all kinds, so that fewer scenes can be told of meanwhile.
"""

import argparse
import json
import os
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from benchmarks.harness import Row, mean, median, percentile_95, share
from benchmarks.search_bounds import least_moves
from benchmarks.search_ours import search_ours
from benchmarks.search_trials import Way, poses_of, search_by
from benchmarks.searching import SHOWN, Trial
from executive.core.errors import InputError
from perception.shelf.affinity import AffinityMatrix, Origin, affinity_from_scores
from perception.shelf.hidden_poses import HiddenPoses
from perception.shelf.language.stored import BEST_MODELS, stored_affinity
from perception.shelf.planning.proofs import pushes_may_show
from perception.shelf.planning.room import Reach
from simulation.shelf.cameras import front_camera
from simulation.shelf.scenes import Scene, SceneRules, draw_scene
from simulation.shelf.taxonomy import Domain, shipped_domain, taxonomy_affinity

DOMAINS = ("pharmacy", "kitchen", "office")
COUNTS = (12, 15, 18, 21)
SUCTION, PUSHES, RANDOM = "suction", "pushes", "rand"
REACHES = {
    SUCTION: Reach(by_sight=True),
    PUSHES: Reach(blade_m=0.0, suction=False, by_sight=True),
    RANDOM: Reach(by_sight=True),
}
FULL_SIZE = 0.7
DRAWS = 2000
# Of every kind of scene this is the first seed; no test and no training uses these.
FIRST_SEED = 700_000
# What others are compared with: the thesis's baseline, and the strongest without semantics.
SPATIAL, EXACT = "spatial_nn", "exact"
LEAST = "least"
# Whether a scene may be solved at all: by pushes alone unless there is a proof against it, else
# where any of the methods has.
SOLVABLE = "solvable"
OURS_ALONE = "ours_no_semantics"


@dataclass(frozen=True, slots=True)
class Kind:
    """One kind of scene."""

    domain: str
    count: int
    regime: str

    @property
    def name(self) -> str:
        """Begins the names of its rows."""
        return f"{self.domain}_{self.count}_{self.regime}"


Method = Callable[[Scene, HiddenPoses], Trial]


def _methods_of(domain: Domain, reach: Reach) -> Mapping[str, Method]:
    """Return the methods by name; those whose affinities are not stored are left out.

    `spatial_nn` is the network in LAX-RAY's manner, the minimum over time, in one dimension;
    `spatial` has its own target in its place, the exact feasible poses of each view. `s4_*`
    multiplies the network's with semantics as the thesis has it. `exact` keeps what any view has
    ruled out. `ours` looks ahead on the belief over poses.
    """
    oracle = affinity_from_scores(domain.names, taxonomy_affinity(domain), Origin("taxonomy"))
    methods: dict[str, Method] = {
        SPATIAL: _way(Way("network", flat=True, reach=reach)),
        "spatial": _way(Way("minimum", flat=True, reach=reach)),
        EXACT: _way(Way("belief", reach=reach)),
        OURS_ALONE: _ours(None, reach),
        "ours_oracle": _ours(oracle, reach),
    }
    for name, make in (
        ("s4_embeddings", lambda: _thesis(stored_affinity(domain.name, "minilm", "thesis"), reach)),
        ("s4_language", lambda: _thesis(_language(domain.name, "thesis"), reach)),
        ("ours", lambda: _ours(_language(domain.name, "symmetric"), reach)),
        ("ours_apache", lambda: _ours(stored_affinity(domain.name), reach)),
    ):
        method = _if_stored(make)
        if method is not None:
            methods[name] = method
    return methods


def _thesis(affinity: AffinityMatrix, reach: Reach) -> Method:
    return _way(Way("network", affinity, flat=True, reach=reach))


def _way(way: Way) -> Method:
    return lambda scene, poses: search_by(scene, way, poses)


def _ours(affinity: AffinityMatrix | None, reach: Reach) -> Method:
    return lambda scene, poses: search_ours(scene, affinity, reach, poses)


def _language(domain: str, recipe: str) -> AffinityMatrix:
    """Return the affinities of the best language model that has scored a domain."""
    try:
        return stored_affinity(domain, BEST_MODELS, recipe)
    except InputError:
        return stored_affinity(domain, "smollm2", recipe)


def _if_stored(make: Callable[[], Method]) -> Method | None:
    try:
        return make()
    except InputError:
        return None


@dataclass(frozen=True, slots=True)
class Job:
    """One scene."""

    kind: Kind
    seed: int

    @property
    def key(self) -> str:
        """Names the scene."""
        return f"{self.kind.name} {self.seed}"


@dataclass(frozen=True, slots=True)
class Solved:
    """What came of one scene: a trial of each method, and how long all took."""

    trials: Mapping[str, Trial]
    took_s: float


def solve(job: Job) -> Solved:
    """Search one scene by every method."""
    begun = time.perf_counter()
    return Solved(_trials(job), time.perf_counter() - begun)


def _trials(job: Job) -> dict[str, Trial]:
    domain = shipped_domain(job.kind.domain)
    reach = REACHES[job.kind.regime]
    rules = SceneRules(
        job.kind.count,
        organisation=0.0 if job.kind.regime == RANDOM else 1.0,
        # Where the thesis's scale of a domain is less than 0.7, full size is as much less.
        scale=min(1.0, domain.scale / FULL_SIZE) if job.kind.regime == PUSHES else None,
    )
    scene = draw_scene(domain, rules, np.random.default_rng(job.seed))
    poses = poses_of(scene)
    methods = _methods_of(domain, reach)
    found = {name: method(scene, poses) for name, method in methods.items()}
    least = least_moves(scene, reach)
    # With a cup there is no proof: what nobody has solved may be solvable.
    solved = any(trial.success for trial in (*found.values(), least))
    may = _pushes_may_solve(scene, reach) if job.kind.regime == PUSHES else solved
    return {**found, LEAST: least, SOLVABLE: Trial(may, 0)}


def _pushes_may_solve(scene: Scene, reach: Reach) -> bool:
    """Say whether there is no proof that pushes cannot solve a scene."""
    target, camera = scene.names.index(scene.target), front_camera(scene.shelf)
    return pushes_may_show(
        scene.boxes, target, scene.shelf, camera, reach.gap_m, share=SHOWN, by_sight=reach.by_sight
    )


def run(quick: bool, seed: int, words: Sequence[str] = ()) -> Sequence[Row]:
    """Run all kinds; two scenes each of a few when quick."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks search")
    parser.add_argument("--kept", type=Path, help="file of scenes that are over")
    kept: Path | None = parser.parse_args(words).kept
    scenes = 2 if quick else int(os.environ.get("SEARCH_SCENES", "200"))
    kinds = _kinds()[::5] if quick else _kinds()
    jobs = [
        Job(kind, FIRST_SEED + 10_000 * seed + number) for number in range(scenes) for kind in kinds
    ]
    workers = int(os.environ.get("SEARCH_WORKERS", str(os.cpu_count() or 1)))
    solved = _solved(jobs, workers, kept)
    trials = [solved[job.key].trials for job in jobs]
    took_s = sum(solved[job.key].took_s for job in jobs) / workers
    rows: list[Row] = []
    for kind in kinds:
        mine = [trial for job, trial in zip(jobs, trials, strict=True) if job.kind == kind]
        rows += _rows(kind.name, [kind.count] * len(mine), mine)
    for group in sorted({(kind.domain, kind.regime) for kind in kinds}):
        members = [
            trial
            for job, trial in zip(jobs, trials, strict=True)
            if (job.kind.domain, job.kind.regime) == group
        ]
        rows += _pooled("_".join(group), members)
    return [*rows, *_times(trials, took_s)]


def _kinds() -> list[Kind]:
    kinds = [
        Kind(domain, count, regime)
        for regime in (SUCTION, PUSHES)
        for domain in DOMAINS
        for count in COUNTS
    ]
    return kinds + [Kind(domain, 15, RANDOM) for domain in DOMAINS]


def _solved(jobs: Sequence[Job], workers: int, kept: Path | None) -> Mapping[str, Solved]:
    """Return what came of each scene, by its key; those that are written down are not searched."""
    solved = _read(kept)
    left = [job for job in jobs if job.key not in solved]
    with ProcessPoolExecutor(max_workers=workers) as pool:
        for number, (job, one) in enumerate(zip(left, pool.map(solve, left), strict=True), 1):
            solved[job.key] = one
            if kept is not None:
                with kept.open("a", encoding="utf-8") as file:
                    file.write(json.dumps({"key": job.key, **asdict(one)}) + "\n")
            if number % 50 == 0:
                print(f"{number} of {len(left)} scenes", file=sys.stderr, flush=True)
    return solved


def _read(kept: Path | None) -> dict[str, Solved]:
    if kept is None or not kept.exists():
        return {}
    rows = [json.loads(line) for line in kept.read_text(encoding="utf-8").splitlines()]
    return {
        row["key"]: Solved(
            {name: Trial(**trial) for name, trial in row["trials"].items()}, row["took_s"]
        )
        for row in rows
    }


def _methods(trials: Sequence[Mapping[str, Trial]]) -> list[str]:
    return [name for name in trials[0] if name != SOLVABLE]


def _rows(name: str, counts: Sequence[int], trials: Sequence[Mapping[str, Trial]]) -> list[Row]:
    """Return actions with failures capped, method by method."""
    return [
        mean(f"{name}_{method}_capped", _capped(counts, trials, method).tolist(), "1")
        for method in _methods(trials)
    ]


def _pooled(name: str, trials: Sequence[Mapping[str, Trial]]) -> list[Row]:
    """Return success, and changes of actions, over all numbers of objects."""
    goal = ">= 0.95" if name.endswith(PUSHES) else ">= 0.98"
    solvable = [trial for trial in trials if trial[SOLVABLE].success]
    rows = [share(f"{name}_solvable", len(solvable), len(trials))]
    for among, some in (("", trials), ("_of_solvable", solvable)):
        rows += [
            share(
                f"{name}_{method}_success{among}",
                sum(trial[method].success for trial in some),
                len(some),
                goal if method.startswith("ours") else "",
            )
            for method in (_methods(trials) if some else ())
        ]
    return rows + [
        _change(f"{name}_{method}_actions_vs_{base}", trials, method, base)
        for method in _methods(trials)
        for base in (SPATIAL, EXACT)
        if method not in (base, SPATIAL)
    ]


def _capped(
    counts: Sequence[int], trials: Sequence[Mapping[str, Trial]], method: str
) -> np.ndarray:
    return np.array(
        [
            trial[method].actions if trial[method].success else 2 * count
            for count, trial in zip(counts, trials, strict=True)
        ],
        dtype=float,
    )


def _change(name: str, trials: Sequence[Mapping[str, Trial]], method: str, base: str) -> Row:
    """Return the relative change of actions over scenes that both have solved, bootstrapped."""
    both = [trial for trial in trials if trial[method].success and trial[base].success]
    if not both:
        return Row(name, float("nan"), "1", 0, float("nan"), float("nan"))
    pairs = np.array([(trial[method].actions, trial[base].actions) for trial in both], dtype=float)
    rng = np.random.default_rng(0)
    draws = pairs[rng.integers(len(pairs), size=(DRAWS, len(pairs)))].sum(axis=1)
    changes = draws[:, 0] / np.maximum(draws[:, 1], 1.0) - 1.0
    low, high = np.quantile(changes, [0.025, 0.975]).tolist()
    value = float(pairs[:, 0].sum() / max(pairs[:, 1].sum(), 1.0) - 1.0)
    return Row(name, value, "1", len(both), low, high)


def _times(trials: Sequence[Mapping[str, Trial]], took_s: float) -> list[Row]:
    """Return how long beliefs and decisions take, and how many searches are made a minute."""
    ours = [trial[OURS_ALONE] for trial in trials]
    beliefs = [time_s for trial in ours for time_s in trial.belief_s]
    choices = [time_s for trial in ours for time_s in trial.choice_s]
    searches = len(trials) * len(_methods(trials))
    rate = 60.0 * searches / took_s
    return [
        median("look_and_belief_s", beliefs, "s", "<= 0.05"),
        median("decision_s", choices, "s", "<= 0.5"),
        percentile_95("decision_p95_s", choices, "s", "<= 0.5"),
        Row("searches_a_minute", rate, "1/min", searches, rate, rate, ">= 200"),
    ]
