"""Follow one of several cables: tiers B1 to B3 as the thesis has them, and photographs.

Tiers are drawn, see `benchmarks.dropped_cables`. A trace starts at a cable's free end; all
three adapters are known. It is right when it follows its cable all the way to its adapter.
Photographs count where they are at hand, see `benchmarks.photographs`.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from benchmarks.dropped_cables import draw_tier
from benchmarks.harness import Row, mean, median, share
from benchmarks.photographs import annotated_traces, followed, labelled_images, told_apart
from perception.cable.following import followed_share
from perception.cable.interfaces import Tracer
from perception.cable.tracers.analytic import AnalyticTracer
from perception.cable.tracers.both_ways import BothWaysTracer
from perception.cable.tracers.learned import LearnedTracer
from perception.cable.tracers.skeleton import SkeletonTracer, SkeletonTracerConfig
from perception.cable.tracers.transitions import ThreadingConfig
from perception.cable.types import Endpoint, Trace
from perception.models.store import FOLDER
from perception.training.calibration import expected_calibration_error, selective_error
from perception.training.scenes import Scene

Floats = NDArray[np.float64]

SEED = 940_001
TIERS = ("B1", "B2", "B3")
# Each crossing by itself, the way that bends least, as mBEST does it (Choi et al. 2023).
EACH_BY_ITSELF = SkeletonTracerConfig(threading=ThreadingConfig(most=1, ring_cost=0.0))
TRACERS: dict[str, Callable[[], Tracer]] = {
    "": lambda: BothWaysTracer(LearnedTracer(FOLDER / "tracer_v2")),
    "_skeleton": SkeletonTracer,
    "_analytic": AnalyticTracer,
}
PHOTOGRAPH_TRACERS: dict[str, Callable[[], Tracer]] = {
    **TRACERS,
    "_least_bending": lambda: SkeletonTracer(EACH_BY_ITSELF),
}
# Nodes of a centre line are half a cable width apart.
START_NODES = 16
DIRECTION_NODES = 8


@dataclass(frozen=True, slots=True, eq=False)
class Task:
    """A scene, the cable that is to be traced, from its free end, and all adapters."""

    scene: Scene
    line_px: Floats
    adapters: tuple[Endpoint, ...]


def run(quick: bool, seed: int) -> Sequence[Row]:
    """Trace in 30 scenes a tier (6 when quick), and in all photographs (none when quick)."""
    wanted = 6 if quick else 30
    rows: list[Row] = []
    believed: list[tuple[float, bool]] = []
    for tier in TIERS:
        tasks = [draw_task(tier, seed, number) for number in range(wanted)]
        for suffix, make in TRACERS.items():
            tracer = make()
            traces = [_traced(tracer, task) for task in tasks]
            right = [is_right(*pair) for pair in zip(tasks, traces, strict=True)]
            goal = ">= 0.967" if not suffix else ""
            rows.append(share(tier + suffix, sum(right), wanted, goal))
            if not suffix:
                beliefs = [trace.probability if trace is not None else 0.0 for trace in traces]
                believed += zip(beliefs, right, strict=True)
    rows += _calibration(believed, np.random.default_rng(seed))
    return rows if quick else rows + _photographs()


def _calibration(believed: Sequence[tuple[float, bool]], rng: np.random.Generator) -> list[Row]:
    """Return how well beliefs in traces hold; intervals by resampling the traces."""
    pairs = np.array(believed, dtype=float)
    drawn = [pairs[rng.integers(len(pairs), size=len(pairs))] for _ in range(400)]
    rows = []
    for name, measure, goal in (
        ("trace_calibration_error", expected_calibration_error, "<= 0.05"),
        ("error_of_surest_80", selective_error, "<= 0.01"),
    ):
        low, high = np.percentile([measure(*sample.T) for sample in drawn], [2.5, 97.5])
        rows.append(Row(name, measure(*pairs.T), "1", len(pairs), float(low), float(high), goal))
    return rows


def _photographs() -> list[Row]:
    tasks, rows = list(annotated_traces()), []
    for suffix, make in PHOTOGRAPH_TRACERS.items() if tasks else ():
        tracer = make()
        shares = [followed(tracer, task) for task in tasks]
        hits = sum(value >= 0.95 for value in shares)
        goal = ">= 0.8" if not suffix else ""
        rows.append(share("real_followed_95" + suffix, hits, len(tasks), goal))
        rows.append(median("real_followed_median" + suffix, shares, "1"))
    images = list(labelled_images())
    for suffix, grey in {"": _brightest, "_grey": _greyed}.items() if images else ():
        results = [told_apart(grey(labelled.image), labelled.labels) for labelled in images]
        counted = sum(right for right, _ in results)
        rows.append(share("mbest_counts" + suffix, counted, len(images), "= 1"))
        rows.append(mean("mbest_dice" + suffix, [dice for _, dice in results], "1", ">= 0.96"))
    return rows


def _brightest(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return np.asarray(image.max(axis=2), np.uint8)


def _greyed(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), np.uint8)


def draw_task(tier: str, seed: int, number: int) -> Task:
    """Return one task of a tier; every cable gets its turn."""
    scene = draw_tier(np.random.default_rng([SEED, seed, TIERS.index(tier), number]), tier)
    lines = [cable.points_px for cable in scene.cables]
    adapters = tuple(_adapter(line) for line in lines)
    return Task(scene, lines[number % len(lines)][::-1], adapters)


def _adapter(line_px: Floats) -> Endpoint:
    inwards = line_px[DIRECTION_NODES] - line_px[0]
    return Endpoint(line_px[0], inwards / np.linalg.norm(inwards), 1.0)


def _traced(tracer: Tracer, task: Task) -> Trace | None:
    return tracer.trace(task.scene.image, task.line_px[:START_NODES:2], task.adapters)


def is_right(task: Task, trace: Trace | None) -> bool:
    """Say whether a trace follows its cable from its free end to its adapter."""
    if trace is None or len(trace.points_px) < 2:
        return False
    width_px = task.scene.width_px
    # Connectors hide the ends themselves.
    truth = task.line_px[DIRECTION_NODES:-DIRECTION_NODES]
    tolerance_px, gap_px = 1.3 * width_px, 5.0 * width_px
    if followed_share(truth, trace.points_px, tolerance_px, gap_px) < 1.0:
        return False
    return float(np.linalg.norm(trace.points_px[-1] - task.line_px[-1])) < 5.0 * width_px
