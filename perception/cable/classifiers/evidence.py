"""What classifiers share: sampling along strands, and one antisymmetric decision a crossing.

Evidence is a number that changes its sign when the two strands are exchanged, and so does
the logit of the belief: P(a over b) = 1 - P(b over a) by construction.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np
from scipy.ndimage import map_coordinates

from perception.cable.crossings import CrossingSite, decide, find_sites
from perception.cable.mask import CableMask
from perception.cable.observation import observe
from perception.cable.types import Crossing, Points, Trace
from perception.camera import GreyImage

# However clear an image is, one crossing in a few hundred may be read wrongly.
MOST_CERTAIN = 0.998


def sample(image: GreyImage, points_px: Points) -> Points:
    """Return grey values at points (x, y), shape (..., 2), by bilinear interpolation."""
    x, y = points_px[..., 0], points_px[..., 1]
    values: Points = map_coordinates(
        image, [y, x], order=1, mode="nearest", output=np.float64, prefilter=False
    )
    return values


def along_strand(
    site: CrossingSite, which: int, along_px: Points, aside_px: Points | float
) -> Points:
    """Return points at distances along and beside one strand through a site."""
    direction = site.directions[which]
    normal = np.array([-direction[1], direction[0]])
    along, aside = np.broadcast_arrays(along_px, aside_px)
    return site.position_px + along[..., None] * direction + aside[..., None] * normal


def sine(site: CrossingSite) -> float:
    """Return the sine of the angle between the strands, kept away from zero."""
    (ax, ay), (bx, by) = site.directions
    return max(abs(float(ax * by - ay * bx)), 0.3)


def probability(evidence: float, gain: float) -> float:
    """Return the belief that belongs to antisymmetric evidence."""
    belief = 1.0 / (1.0 + math.exp(-min(max(gain * evidence, -30.0), 30.0)))
    return 1.0 - MOST_CERTAIN + (2.0 * MOST_CERTAIN - 1.0) * belief


class EvidenceClassifier(ABC):
    """A crossing classifier that weighs one number a crossing."""

    def __init__(self, gain: float) -> None:
        """Keep the gain of the logit."""
        self._gain = gain

    def classify(self, image: GreyImage, traces: Sequence[Trace]) -> tuple[Crossing, ...]:
        """Return every crossing; see `CrossingClassifier.classify`."""
        observation = observe(image)
        if observation is None:
            return ()
        return tuple(
            decide(site, probability(self.evidence(image, observation.mask, site), self._gain))
            for site in find_sites(traces)
        )

    @abstractmethod
    def evidence(self, image: GreyImage, mask: CableMask, site: CrossingSite) -> float:
        """Return how much speaks for strand a on top, negative for strand b."""
