"""How much an image tells of over and under at all: drawn crossings, and the same swapped.

Of a drawn scene everything is known, so it can be drawn again with the upper strand below and
all else, noise included, as it was. By how much both images differ, over the noise of one of
them, bounds what anybody can know: a judge who knew all but over and under, and weighed each
pixel as it deserves, would be right with probability Phi(d / 2), d being the length of the
difference over the standard deviation of the noise (Green and Swets, "Signal detection theory
and psychophysics", 1966). Nobody knows all else, so real judges are right less often.
"""

from collections.abc import Iterator
from copy import deepcopy
from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from benchmarks.crossing_scenes import SEED
from benchmarks.harness import Row, share
from perception.camera import GreyImage
from perception.training.looks import Lens
from perception.training.photograph import photograph
from perception.training.scenes import Laid, SceneConfig, SceneCrossing, lay, seen_lines, shoot

Floats = NDArray[np.float64]

# Smaller differences leave even a judge who knows all else wrong in one of six [noise].
UNSEEN = 2.0
# Strands are lifted over each other along this length [nodes], as scenes are laid.
LIFT_NODES = 3.0
# Rounding to whole grey values is noise of its own.
ROUNDING = np.sqrt(1.0 / 12.0)
PATCH_PX = 96
# What is drawn differs this near to a crossing, and as lone pixels anywhere.
NEAR_WIDTHS, LONE_PX = 3.0, 3


def cue_rows(seed: int, count: int) -> list[Row]:
    """Return how often swapped crossings cannot be told, and how often one could be right."""
    found = np.array([cue for number in range(count) for cue in cues(seed, number)])
    right = norm.cdf(0.5 * found)
    spread = 1.96 * float(right.std()) / np.sqrt(len(right))
    best = float(right.mean())
    return [
        share("drawn_swap_unseen", int((found < UNSEEN).sum()), len(found)),
        Row("drawn_best_possible", best, "1", len(found), best - spread, min(best + spread, 1.0)),
    ]


def cues(seed: int, number: int) -> Iterator[float]:
    """Yield for each crossing of a drawn scene how far swapping it changes the image [noise]."""
    rng, config = np.random.default_rng([SEED, seed, number]), SceneConfig()
    yield from cues_of(rng, lay(rng, seen_lines(rng, config), config))


def cues_of(rng: np.random.Generator, laid: Laid) -> Iterator[float]:
    """Yield the same for cables as they lie; the generator stays as it is."""
    scene = shoot(deepcopy(rng), laid)[0]
    sigma = noise_of(laid)
    for crossing in scene.crossings:
        cable, node = crossing.over
        place = scene.cables[cable].points_px[int(node)]
        if not ((place > 0.0) & (place < np.array(scene.image.shape[::-1]) - 1.0)).all():
            continue
        other = shoot(deepcopy(rng), swapped(laid, crossing))[0]
        yield float(np.linalg.norm(_change(scene.image, other.image, place, laid.width_px))) / sigma


def _change(one: GreyImage, other: GreyImage, place: Floats, width_px: float) -> Floats:
    """Return how images differ near a place, but for lone pixels.

    Borders of strands are drawn from points that lie elsewhere once heights have changed.
    """
    low = np.maximum(np.rint(place - NEAR_WIDTHS * width_px), 0.0).astype(int)
    high = np.rint(place + NEAR_WIDTHS * width_px).astype(int) + 1
    near = (slice(low[1], high[1]), slice(low[0], high[0]))
    change = other[near].astype(float) - one[near]
    _, parts, told, _ = cv2.connectedComponentsWithStats((change != 0.0).astype(np.uint8))
    lone = told[:, cv2.CC_STAT_AREA] <= LONE_PX
    return np.where(lone[parts], 0.0, change)


def swapped(laid: Laid, crossing: SceneCrossing) -> Laid:
    """Return cables of which two strands have changed places, one below the other."""
    starts = np.searchsorted(laid.cable, np.arange(laid.cable[-1] + 1))
    upper, lower = (starts[cable] + node for cable, node in (crossing.over, crossing.under))
    number = np.arange(len(laid.nodes))
    apart = float(np.diff(np.interp([lower, upper], number, laid.nodes[:, 2]))[0])
    nodes = laid.nodes.copy()
    for (cable, _), at, way in ((crossing.over, upper, -1.0), (crossing.under, lower, 1.0)):
        lift = way * apart * np.exp(-(((number - at) / LIFT_NODES) ** 2))
        nodes[:, 2] += np.where(laid.cable == cable, lift, 0.0)
    # Nothing sinks into the table, where it would not be drawn.
    on_table = 0.5 * np.array([cable.width for cable in laid.look.cables])[laid.cable]
    nodes[:, 2] = np.maximum(nodes[:, 2], on_table)
    return replace(laid, nodes=nodes)


def noise_of(laid: Laid) -> float:
    """Return the standard deviation of what a camera adds to a scene [grey values]."""
    lens: Lens = replace(laid.look.lens, salt=0.0)
    rng, flat = np.random.default_rng(0), np.full((PATCH_PX, PATCH_PX), 128.0, np.float32)
    seen = photograph(rng, flat, laid.width_px, lens).astype(float)
    return float(np.hypot(seen.std(), ROUNDING))
