"""Tracing one of several cables from its end, in drawn scenes on seeds that training never saw.

The scenes come from the generator that the learned tracer is trained on: they compare
tracers with each other. They are not the tiers B1 to B3 of the thesis, which are photographs.
A trace is right when it follows its cable all the way and ends at its other end.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.following import followed_share
from benchmarks.harness import Row, share
from perception.cable.interfaces import Tracer
from perception.cable.tracers.analytic import AnalyticTracer
from perception.cable.tracers.learned import LearnedTracer
from perception.cable.tracers.skeleton import SkeletonTracer
from perception.cable.types import Endpoint
from perception.models.store import FOLDER
from perception.training.scenes import Scene, SceneCable, SceneConfig, make_scene

Floats = NDArray[np.float64]

SEED = 940_001
TABLE = SceneConfig(extent=90.0, size_px=(773, 1032), narrowest_px=5.0, widest_px=7.0, bright=True)
TIERS = {
    "one_crossing": replace(TABLE, family="random", cables=1),
    "three_crossing": replace(TABLE, family="random", cables=3),
    "one_wound": replace(TABLE, family="dense", cables=1),
}
TRACERS: dict[str, Callable[[], Tracer]] = {
    "": lambda: LearnedTracer(FOLDER / "tracer_v1"),
    "_skeleton": SkeletonTracer,
    "_analytic": AnalyticTracer,
}
# Nodes of a centre line are half a cable width apart.
START_NODES = 16
DIRECTION_NODES = 8


@dataclass(frozen=True, slots=True, eq=False)
class Task:
    """A scene whose first cable is to be traced, and lies in view as a whole."""

    scene: Scene
    ends: tuple[Endpoint, ...]


def run(quick: bool, seed: int) -> Sequence[Row]:
    """Trace in 40 scenes a tier (6 when quick)."""
    wanted = 6 if quick else 40
    rows = []
    for tier, config in TIERS.items():
        tasks = draw_tasks(config, seed, wanted)
        for suffix, make in TRACERS.items():
            tracer = make()
            right = sum(is_right(tracer, task) for task in tasks)
            rows.append(share(tier + suffix, right, wanted))
    return rows


def draw_tasks(config: SceneConfig, seed: int, wanted: int) -> list[Task]:
    """Return the first scenes of a seed whose first cable lies in view as a whole."""
    tasks: list[Task] = []
    number = 0
    while len(tasks) < wanted:
        scene = make_scene(np.random.default_rng([SEED, seed, number]), config)
        number += 1
        if _in_view(scene, scene.cables[0]):
            ends = [end for cable in scene.cables for end in _ends(scene, cable)]
            tasks.append(Task(scene, tuple(ends)))
    return tasks


def is_right(tracer: Tracer, task: Task) -> bool:
    """Say whether a tracer follows the first cable from its first end to its last."""
    line, width_px = task.scene.cables[0].points_px, task.scene.width_px
    trace = tracer.trace(task.scene.image, line[:START_NODES:2], task.ends)
    if trace is None or len(trace.points_px) < 2:
        return False
    # Connectors hide the ends themselves.
    truth = line[DIRECTION_NODES:-DIRECTION_NODES]
    tolerance_px, gap_px = 1.3 * width_px, 5.0 * width_px
    if followed_share(truth, trace.points_px, tolerance_px, gap_px) < 1.0:
        return False
    return float(np.linalg.norm(trace.points_px[-1] - line[-1])) < 5.0 * width_px


def _in_view(scene: Scene, cable: SceneCable) -> bool:
    size = np.array(scene.image.shape[::-1])
    return bool((cable.points_px > 12.0).all() and (cable.points_px < size - 12.0).all())


def _ends(scene: Scene, cable: SceneCable) -> list[Endpoint]:
    size = np.array(scene.image.shape[::-1])
    ends = []
    for line in (cable.points_px, cable.points_px[::-1]):
        inwards = line[DIRECTION_NODES] - line[0]
        if (line[0] > 0.0).all() and (line[0] < size).all():
            ends.append(Endpoint(line[0], inwards / np.linalg.norm(inwards), 1.0))
    return ends
