"""What tracers are asked to do in drawn scenes, and when an answer is right."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.dropped_cables import LENGTHS, draw_tier_images
from benchmarks.laying import CONFIG, HIGH, LOW, Core, laid
from perception.cable.following import followed_share
from perception.cable.interfaces import Tracer
from perception.cable.types import Endpoint, Trace
from perception.training.scenes import Scene, lay_scene

Floats = NDArray[np.float64]

SEED = 940_001
TIERS = ("B1", "B2", "B3")
# Nodes of a centre line are half a cable width apart.
START_NODES = 16
DIRECTION_NODES = 8
# A straight piece that a single cable grows from to both sides.
STRAIGHT = np.array([[-2.0, 0.0], [0.0, 0.0], [2.0, 0.0]])
TRIES = 100


@dataclass(frozen=True, slots=True, eq=False)
class Task:
    """A scene, the cable that is to be traced, from its free end, and all ends that are known."""

    scene: Scene
    line_px: Floats
    ends: tuple[Endpoint, ...]

    @property
    def start_px(self) -> Floats:
        """The cable's first points, about eight of its widths long."""
        return self.line_px[:START_NODES:2]


def draw_tasks(tier: str, seed: int, number: int) -> tuple[Task, ...]:
    """Return one task of a tier, once for each image of its scene; every cable gets its turn."""
    rng = np.random.default_rng([SEED, seed, TIERS.index(tier), number])
    tasks = []
    for scene in draw_tier_images(rng, tier):
        lines = [cable.points_px for cable in scene.cables]
        adapters = tuple(end_of(line) for line in lines)
        tasks.append(Task(scene, lines[number % len(lines)][::-1], adapters))
    return tuple(tasks)


def draw_single(seed: int, number: int) -> Task:
    """Return the task of tracing one dropped cable of 3 m, both ends known."""
    rng = np.random.default_rng([SEED, seed, len(TIERS), number])
    for _ in range(TRIES):
        place = rng.uniform(LOW + 30.0, HIGH - 30.0)
        found = laid(rng, [Core(place + STRAIGHT)], LENGTHS[:1], [])
        if found is not None:
            scene = lay_scene(rng, found[0], CONFIG)
            line = scene.cables[0].points_px
            return Task(scene, line[::-1], (end_of(line), end_of(line[::-1])))
    raise RuntimeError(f"no cable by itself in {TRIES} tries")


def end_of(line_px: Floats) -> Endpoint:
    """Return the end that a line begins with."""
    inwards = line_px[DIRECTION_NODES] - line_px[0]
    return Endpoint(line_px[0], inwards / np.linalg.norm(inwards), 1.0)


def traced(tracer: Tracer, task: Task) -> Trace | None:
    """Return a tracer's answer."""
    return tracer.trace(task.scene.image, task.start_px, task.ends)


def is_right(task: Task, trace: Trace | None) -> bool:
    """Say whether a trace follows its cable from one end to the other."""
    if trace is None or len(trace.points_px) < 2:
        return False
    width_px = task.scene.width_px
    # Connectors hide the ends themselves.
    truth = task.line_px[DIRECTION_NODES:-DIRECTION_NODES]
    tolerance_px, gap_px = 1.3 * width_px, 5.0 * width_px
    if followed_share(truth, trace.points_px, tolerance_px, gap_px) < 1.0:
        return False
    return float(np.linalg.norm(trace.points_px[-1] - task.line_px[-1])) < 5.0 * width_px


def most_are_right(tracer: Tracer, images: Sequence[Task]) -> tuple[bool, Trace | None, bool]:
    """Trace in images of one scene until most of them are known to be right or wrong.

    Returns:
        Whether at least two of three (most of any odd number) are right; the trace in the first
        image, and whether that is right.
    """
    first = traced(tracer, images[0])
    first_right = is_right(images[0], first)
    right, wrong, most = int(first_right), int(not first_right), len(images) // 2 + 1
    for task in images[1:]:
        if max(right, wrong) >= most:
            break
        hit = is_right(task, traced(tracer, task))
        right, wrong = right + hit, wrong + (not hit)
    return right >= most, first, first_right
