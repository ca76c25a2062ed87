"""Over and under as in the thesis: each visit by itself, then one of two equal labels flipped.

Shivakumar 2023, section 3.2 and "Crossing Correction". It is the baseline; beliefs are the
thesis's rescaled scores, which are not calibrated.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import torch

from perception.cable.classifiers.passes import StrandPass, passes_of, path_through
from perception.cable.crossings import decide, find_sites
from perception.cable.types import Crossing, Trace
from perception.cable.width import width_under
from perception.camera import GreyImage
from perception.models.frames import Crop, ScaledImage, scale_image
from perception.models.store import load_network
from perception.models.thesis_crossing_crop import REACH, WIDTH, make_visit

THRESHOLD = 0.275


class ThesisClassifier:
    """Implements `CrossingClassifier` with the thesis's network and rules.

    Args:
        folder: A trained version, see `perception.models.store`.
    """

    def __init__(self, folder: Path) -> None:
        self._network = load_network(folder)

    def classify(self, image: GreyImage, traces: Sequence[Trace]) -> tuple[Crossing, ...]:
        """Return every crossing; see `CrossingClassifier.classify`."""
        if not traces:
            return ()
        width_px = width_under(image, [trace.points_px for trace in traces])
        sites = find_sites(traces, width_px)
        if not sites:
            return ()
        scaled = scale_image(image, width_px, WIDTH)
        visits = [_visit(scaled, strand) for site in sites for strand in passes_of(site, traces)]
        scores = self._scores(np.stack(visits)).reshape(-1, 2).tolist()
        return tuple(
            decide(site, corrected(first, second))
            for site, (first, second) in zip(sites, scores, strict=True)
        )

    @torch.inference_mode()
    def _scores(self, visits: Crop) -> Crop:
        scores: Crop = torch.sigmoid(self._network(torch.from_numpy(visits))).numpy()
        return scores


def _visit(scaled: ScaledImage, strand: StrandPass) -> Crop:
    inside = StrandPass(scaled.into(strand.line), strand.at * scaled.scale)
    return make_visit(scaled, path_through(inside, REACH, 1.0))


def corrected(first: float, second: float) -> float:
    """Return the belief that the first visit is on top, given the scores of both.

    Of two equal labels the less confident one is flipped, and its confidence p becomes 1 - p.
    The belief is the mean of both confidences.
    """
    over = (first >= THRESHOLD, second >= THRESHOLD)
    sure = (confidence(first), confidence(second))
    if over[0] != over[1]:
        belief = 0.5 * (sure[0] + sure[1])
        return belief if over[0] else 1.0 - belief
    belief = 0.5 * (1.0 + abs(sure[0] - sure[1]))
    first_is_over = over[0] == (sure[0] >= sure[1])
    return belief if first_is_over else 1.0 - belief


def confidence(score: float) -> float:
    """Return the thesis's confidence in a label: its score, rescaled to [0.5, 1]."""
    beyond = score - THRESHOLD
    return 0.5 + 0.5 * beyond / (1.0 - THRESHOLD if beyond >= 0.0 else -THRESHOLD)
