"""Follow one of several cables: tiers B1 to B3 as the thesis has them, and photographs.

Tiers are drawn, see `benchmarks.dropped_cables`. A trace starts at a cable's free end; all
three adapters are known. It is right when it follows its cable all the way to its adapter; as in
the thesis, a scene counts when two of three images of it are traced right. Beliefs are held to
first images, and to cables of 3 m by themselves, which times are measured on as well: of tracing
from a known end, of a step, and of all that perception does with an image of which nothing is
known (`image_s`), also over what takes no network (`image_over_classic`).
Photographs count where they are at hand, see `benchmarks.photographs`.
"""

import time
from collections.abc import Callable, Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from benchmarks.harness import Row, mean, median, percentile_95, share
from benchmarks.photographs import annotated_traces, followed, labelled_images, told_apart
from benchmarks.tracing_tasks import (
    TIERS,
    Task,
    draw_single,
    draw_tasks,
    is_right,
    most_are_right,
    traced,
)
from executive.app.compose import cable_vision
from perception.cable import parts
from perception.cable.interfaces import Tracer
from perception.cable.tracers.analytic import AnalyticTracer
from perception.cable.tracers.learned import LearnedTracer
from perception.cable.tracers.skeleton import SkeletonTracer, SkeletonTracerConfig
from perception.cable.tracers.transitions import ThreadingConfig
from perception.cable.types import Trace
from perception.cable.vision import GreyImageVision
from perception.models.store import FOLDER
from perception.training.calibration import expected_calibration_error, selective_error

# Each crossing by itself, the way that bends least, as mBEST does it (Choi et al. 2023).
EACH_BY_ITSELF = SkeletonTracerConfig(threading=ThreadingConfig(most=1, ring_cost=0.0))
TRACERS: dict[str, Callable[[], Tracer]] = {
    "": lambda: parts.TRACERS["learned"](parts.EYES["learned"]()),
    "_skeleton": SkeletonTracer,
    "_analytic": AnalyticTracer,
    "_least_bending": lambda: SkeletonTracer(EACH_BY_ITSELF),
}
SCENES, SINGLES = 30, 40
QUICK_SCENES, QUICK_SINGLES = 3, 4


def run(quick: bool, seed: int) -> Sequence[Row]:
    """Trace in 30 scenes a tier (3 when quick), and in all photographs (none when quick)."""
    rows, believed = _tiers(seed, QUICK_SCENES if quick else SCENES)
    singles = [draw_single(seed, k) for k in range(QUICK_SINGLES if quick else SINGLES)]
    single_rows, single_believed = _singles(singles)
    rng = np.random.default_rng(seed)
    rows += single_rows + _whole_images(singles)
    rows += _calibration("", [*believed, *single_believed], rng)
    rows += _calibration("_tiers", believed, rng) + _calibration("_single", single_believed, rng)
    return rows if quick else rows + _photographs()


def _tiers(seed: int, wanted: int) -> tuple[list[Row], list[tuple[float, bool]]]:
    """Return how many scenes of each tier each tracer follows, and our beliefs."""
    rows: list[Row] = []
    believed: list[tuple[float, bool]] = []
    tracers = {suffix: make() for suffix, make in TRACERS.items()}
    for tier in TIERS:
        hits = dict.fromkeys(tracers, 0)
        for number in range(wanted):
            images = draw_tasks(tier, seed, number)
            for suffix, tracer in tracers.items():
                good, first, right = most_are_right(tracer, images)
                hits[suffix] += good
                if not suffix:
                    believed.append((_belief(first), right))
        goals = {"": ">= 0.967"}
        rows += [share(tier + s, hits[s], wanted, goals.get(s, "")) for s in tracers]
    return rows, believed


def _singles(tasks: Sequence[Task]) -> tuple[list[Row], list[tuple[float, bool]]]:
    """Return how many single cables are followed, how long that takes, and our beliefs."""
    ours, one_way, skeleton = TRACERS[""](), LearnedTracer(FOLDER / parts.TRACER), SkeletonTracer()
    for warm in (ours, one_way, skeleton):
        traced(warm, tasks[0])
    timed = [[_timed(tracer, task) for task in tasks] for tracer in (ours, one_way, skeleton)]
    answers = [(trace, task) for (trace, _), task in zip(timed[0], tasks, strict=True)]
    believed = [(_belief(trace), is_right(task, trace)) for trace, task in answers]
    seconds = [[took_s for _, took_s in each] for each in timed]
    steps = [1e3 * took_s / len(trace.points_px) for trace, took_s in timed[1] if trace is not None]
    over = [mine / other for mine, other in zip(seconds[0], seconds[2], strict=True)]
    return [
        share("single", sum(right for _, right in believed), len(tasks), ">= 0.967"),
        median("trace_s", seconds[0], "s", "<= 1"),
        median("step_ms", steps, "ms", "<= 4"),
        median("trace_over_skeleton", over, "1"),
    ], believed


def _whole_images(tasks: Sequence[Task]) -> list[Row]:
    """Return how long all of perception takes on images of single cables, with no end known."""
    ours, classic = cable_vision(), GreyImageVision()
    for warm in (ours, classic):
        warm.scene(tasks[0].scene.image)
    seconds = [
        [vision.scene(task.scene.image).seconds for task in tasks] for vision in (ours, classic)
    ]
    over = [mine / other for mine, other in zip(*seconds, strict=True)]
    return [
        median("image_s", seconds[0], "s", "<= 1"),
        percentile_95("image_s_p95", seconds[0], "s"),
        median("image_over_classic", over, "1"),
    ]


def _timed(tracer: Tracer, task: Task) -> tuple[Trace | None, float]:
    began_s = time.perf_counter()
    trace = traced(tracer, task)
    return trace, time.perf_counter() - began_s


def _belief(trace: Trace | None) -> float:
    return trace.probability if trace is not None else 0.0


def _calibration(
    suffix: str, believed: Sequence[tuple[float, bool]], rng: np.random.Generator
) -> list[Row]:
    """Return how well beliefs in traces hold; intervals by resampling the traces."""
    pairs = np.array(believed, dtype=float)
    drawn = [pairs[rng.integers(len(pairs), size=len(pairs))] for _ in range(400)]
    rows = []
    for name, measure, goal in (
        ("trace_calibration_error", expected_calibration_error, "<= 0.05"),
        ("error_of_surest_80", selective_error, "<= 0.01"),
    ):
        low, high = np.percentile([measure(*sample.T) for sample in drawn], [2.5, 97.5])
        rows.append(
            Row(name + suffix, measure(*pairs.T), "1", len(pairs), float(low), float(high), goal)
        )
    return rows


def _photographs() -> list[Row]:
    tasks, rows = list(annotated_traces()), []
    for suffix, make in TRACERS.items() if tasks else ():
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
