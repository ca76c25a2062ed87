"""The detector beside the classic mask and ends, in the same run on the same images.

Drawn scenes have looks, clutter and cables of many kinds, on fresh seeds. The classic steps know
only bright cables: on drawn scenes they are given the image or its negative, whichever they do
better on. The cell's own camera casts rays on simulated cables; photographs are for evaluation
only. An end counts as found within 1.5 cable widths. Seconds are those of the processor, as the
machine is shared.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

from benchmarks.harness import Row, mean, median, share
from benchmarks.photographs import labelled_images
from perception.cable.observation import observe
from perception.cable.parts import SIGHT
from perception.cable.plug_ends import find_ends
from perception.cable.sight.reading import ReadingConfig
from perception.cable.sight.sight import Sight
from perception.cable.types import Endpoint
from perception.camera import GreyImage
from perception.models.store import FOLDER
from perception.training.sight_scenes import SightTruth, draw_truth
from simulation.cable.configurations import starting_configuration
from simulation.overhead_camera import OverheadCamera
from simulation.table_cell_config import CameraConfig
from simulation.table_world import TableWorld

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

VERSION = FOLDER / SIGHT
SEED = 78_000_000
SIZES_PX = ((480, 640), (672, 896), (772, 1032))
NEAR_WIDTHS = 1.5
# The middle of a plug's body is this far from where the cable enters it.
PLUG_M = 0.01


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """What one detector says about one image.

    Attributes:
        ends: Ends of cables.
        cable: Pixels of cable and connector, or None for none.
        width_px: Width of the cable, or None for none.
    """

    ends: tuple[Endpoint, ...]
    cable: Bools | None
    width_px: float | None


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """An image and what is true about it.

    Attributes:
        image: Grey image.
        ends_px: Ends that can be seen, shape (N, 2).
        hidden_px: Ends under strands or at the border, which nobody is asked for, shape (M, 2).
        cable: Pixels of cable and connector; None where unknown.
        width_px: Width of the cables.
        any_polarity: Whether the classic steps may see the negative.
    """

    image: GreyImage
    ends_px: Floats
    hidden_px: Floats
    cable: Bools | None
    width_px: float
    any_polarity: bool


@dataclass(frozen=True, slots=True)
class Score:
    """How well one image was seen."""

    wanted: int
    found: int
    claimed: int
    false: int
    overlap: float | None
    width_error: float | None
    seconds: float


Looker = Callable[[GreyImage], View]


def run(quick: bool, seed: int) -> Sequence[Row]:
    """Look at 60 drawn scenes, 12 of the cell (6 and 2 when quick), and all photographs."""
    rows: list[Row] = []
    sets = {
        "": [draw_case(seed, k) for k in range(6 if quick else 60)],
        "cell_": [cell_case(seed, k) for k in range(2 if quick else 12)],
        "mbest_": [] if quick else list(_photographs()),
    }
    for prefix, cases in sets.items():
        for suffix, looker in {"": _sight, "_classic": _classic}.items() if cases else ():
            rows += _rows(prefix, suffix, [_scored(looker, case) for case in cases])
    return rows


def _rows(prefix: str, suffix: str, scores: Sequence[Score]) -> list[Row]:
    wanted, claimed = sum(s.wanted for s in scores), sum(s.claimed for s in scores)
    ours = not suffix
    found, false = sum(s.found for s in scores), sum(s.false for s in scores)
    rows = []
    if wanted:
        rows.append(share(f"{prefix}ends_found{suffix}", found, wanted, ">= 0.95" * ours))
        rows.append(share(f"{prefix}ends_false{suffix}", false, max(claimed, 1), "<= 0.05" * ours))
    overlaps = [s.overlap for s in scores if s.overlap is not None]
    if overlaps:
        rows.append(mean(f"{prefix}mask_iou{suffix}", overlaps, "1", ">= 0.85" * ours))
    errors = [s.width_error for s in scores if s.width_error is not None]
    if errors:
        rows.append(median(f"{prefix}width_error{suffix}", errors, "1", "<= 0.08" * ours))
    rows.append(
        median(f"{prefix}seconds{suffix}", [s.seconds for s in scores], "s", "<= 0.25" * ours)
    )
    return rows


@cache
def _detector() -> Sight:
    return Sight(VERSION, ReadingConfig())


def _sight(image: GreyImage) -> View:
    seen = _detector().look(image)
    return View(seen.endpoints, seen.cable_pixels, seen.width_px)


def _classic(image: GreyImage) -> View:
    observation = observe(image)
    if observation is None:
        return View((), None, None)
    ends = find_ends(observation.mask, observation.graph)
    return View(ends, observation.mask.cable, observation.mask.width_px)


def _scored(looker: Looker, case: Case) -> Score:
    began_s = time.process_time()
    view = looker(case.image)
    seconds = time.process_time() - began_s
    score = _score(view, case, seconds)
    if looker is _classic and case.any_polarity:
        other = _score(looker(255 - case.image), case, seconds)
        score = max(score, other, key=lambda each: each.overlap or 0.0)
    return score


def _score(view: View, case: Case, seconds: float) -> Score:
    places = np.array([end.position_px for end in view.ends]).reshape(-1, 2)
    limit = NEAR_WIDTHS * case.width_px
    found = _near(case.ends_px, places, limit)
    excused = _near(places, np.vstack([case.ends_px, case.hidden_px]), limit)
    return Score(
        wanted=len(case.ends_px),
        found=int(found.sum()),
        claimed=len(places),
        false=int((~excused).sum()),
        overlap=_overlap(view.cable, case.cable),
        width_error=None
        if view.width_px is None or case.cable is None or not case.width_px
        else abs(view.width_px / case.width_px - 1.0),
        seconds=seconds,
    )


def _near(these: Floats, those: Floats, limit: float) -> Bools:
    """Say of each place whether one of the others is near."""
    gaps = np.linalg.norm(these[:, None] - those[None], axis=2)
    near: Bools = gaps.min(axis=1, initial=np.inf) < limit
    return near


def _overlap(seen: Bools | None, true: Bools | None) -> float | None:
    """Return intersection over union; 1 where nothing is and nothing is seen."""
    if true is None:
        return None
    seen = np.zeros_like(true) if seen is None else seen
    either = int((seen | true).sum())
    return float((seen & true).sum()) / either if either else 1.0


def draw_case(seed: int, number: int) -> Case:
    """Draw a scene of a fresh seed."""
    rng = np.random.default_rng([SEED, seed, number])
    return case_of(draw_truth(rng, SIZES_PX[number % len(SIZES_PX)]))


def case_of(truth: SightTruth) -> Case:
    """Return a drawn scene as a case."""
    clear = truth.clear_ends(NEAR_WIDTHS)
    return Case(
        truth.image,
        truth.ends[clear],
        truth.ends[~clear],
        truth.shown,
        truth.usual_width_px,
        True,
    )


def cell_case(seed: int, number: int) -> Case:
    """Lay a cable in the cell and take a frame."""
    rng = np.random.default_rng([SEED, seed, number, 1])
    world = TableWorld(
        starting_configuration(("none", "overhand", "figure_8")[number % 3], rng), 240
    )
    frame = OverheadCamera(world, CameraConfig(), rng).capture()
    plugs = world.rod.connector_poses()
    ends_px = frame.camera.project(plugs[:, :3, 3] - PLUG_M * plugs[:, :3, 0])
    width_px = 2.0 * world.rod.parameters.radius_m / CameraConfig().scale_m_px
    return Case(frame.image, ends_px, np.empty((0, 2)), None, width_px, False)


def _photographs() -> Sequence[Case]:
    none = np.empty((0, 2))
    return [
        Case(
            np.asarray(cv2.cvtColor(each.image, cv2.COLOR_BGR2GRAY), np.uint8),
            none,
            none,
            each.labels > 0,
            0.0,
            False,
        )
        for each in labelled_images()
    ]
