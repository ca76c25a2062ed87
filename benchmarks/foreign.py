"""See cables in images of renderers that training has not seen, see `benchmarks.foreign_views`.

Everything is found from the image alone. A view is followed when one trace runs along 95 % of
the cable; its verdict is P(knotted), held against what is tied.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.foreign_views import RENDERERS, View, draw_view
from benchmarks.harness import Row, median, share
from executive.app.compose import cable_vision
from perception.cable.following import followed_share
from perception.cable.interfaces import CableVision
from perception.cable.types import CableScene
from perception.cable.vision import GreyImageVision
from simulation.cable.knots import KnotName

KNOTS: tuple[KnotName, ...] = ("overhand", "figure_8", "none")
# An end counts as found this near to it [cable widths]; connectors are not drawn here.
END_WIDTHS = 2.0
# Nodes at each end that a trace may leave out.
END_NODES = 4
FOLLOWED = 0.95
# A verdict is given from this belief on, either way.
SURE = 0.9


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of one view.

    Attributes:
        followed: Share of the cable that the best trace follows.
        ends: How many of both ends were found.
        belief_in_truth: Belief in what is tied, knotted or not.
        seconds: Time it took.
    """

    followed: float
    ends: int
    belief_in_truth: float
    seconds: float


def run(quick: bool, seed: int) -> Sequence[Row]:
    """Look at 30 views of each renderer (6 when quick), with and without learned parts."""
    wanted = 6 if quick else 30
    rows: list[Row] = []
    for suffix, vision in (("", cable_vision()), ("_classic", GreyImageVision())):
        for renderer in RENDERERS:
            numbers = range(seed * wanted, (seed + 1) * wanted)
            views = (draw_view(renderer, KNOTS[number % 3], number) for number in numbers)
            outcomes = [judge(view, vision) for view in views]
            rows += _rows(f"{renderer}{suffix}", outcomes, "" if suffix else ">= 0.9")
    return rows


def judge(view: View, vision: CableVision) -> Outcome:
    """Look at one view."""
    scene = vision.scene(view.image)
    knotted = view.knot != "none"
    belief = scene.knotted_probability if knotted else 1.0 - scene.knotted_probability
    return Outcome(_followed(view, scene), _ends(view, scene), belief, scene.seconds)


def _followed(view: View, scene: CableScene) -> float:
    truth = view.line_px[END_NODES:-END_NODES]
    tolerance_px, gap_px = 1.3 * view.width_px, 5.0 * view.width_px
    lines = [line for trace in scene.traces for line in (trace.points_px, trace.points_px[::-1])]
    shares = [followed_share(truth, line, tolerance_px, gap_px) for line in lines if len(line) > 1]
    return max(shares, default=0.0)


def _ends(view: View, scene: CableScene) -> int:
    found = np.array([end.position_px for end in scene.endpoints]).reshape(-1, 2)
    gaps = np.linalg.norm(found[None] - view.line_px[[0, -1]][:, None], axis=2)
    return int((gaps.min(axis=1, initial=np.inf) < END_WIDTHS * view.width_px).sum())


def _rows(name: str, outcomes: Sequence[Outcome], goal: str) -> list[Row]:
    n = len(outcomes)
    beliefs = [outcome.belief_in_truth for outcome in outcomes]
    return [
        share(f"followed_{name}", sum(o.followed >= FOLLOWED for o in outcomes), n, goal),
        share(f"ends_{name}", sum(o.ends for o in outcomes), 2 * n, goal),
        share(f"surely_right_{name}", sum(belief >= SURE for belief in beliefs), n),
        share(f"surely_wrong_{name}", sum(belief <= 1.0 - SURE for belief in beliefs), n),
        median(f"seconds_{name}", [outcome.seconds for outcome in outcomes], "s"),
    ]
