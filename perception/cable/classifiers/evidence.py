"""What classifiers share: sampling along strands, and one antisymmetric decision a crossing.

Evidence is a number that changes its sign when the two strands are exchanged, and so does
the logit of the belief: P(a over b) = 1 - P(b over a) by construction.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from perception.cable.crossings import CrossingSite, decide, find_sites
from perception.cable.crowding import doubt_shared
from perception.cable.mask import CableMask
from perception.cable.observation import observe
from perception.cable.tracers.centre_line import tangents
from perception.cable.types import Crossing, Points, Trace
from perception.camera import GreyImage

# However clear an image is, one crossing in a few hundred may be read wrongly.
MOST_CERTAIN = 0.998
# Nearer than this, a third strand hides the edges that evidence is taken from.
SHARED_WIDTHS = 1.5


def sample(image: GreyImage, places_px: Points) -> Points:
    """Return grey values at places (x, y), shape (K, M, 2), by bilinear interpolation."""
    x, y = (np.ascontiguousarray(places_px[..., axis], dtype=np.float32) for axis in (0, 1))
    values = cv2.remap(image, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(values, dtype=float)


@dataclass(frozen=True, slots=True, eq=False)
class Ribbon:
    """Grey values on and beside one strand through a crossing, bent with the strand.

    Attributes:
        values: Grey values, shape (K, M): K places along the strand, M beside it.
        aside_px: Distances of the M places from its centre line.
        other_px: Signed distance of each place to the other strand's centre line, (K, M).
    """

    values: Points
    aside_px: Points
    other_px: Points


def ribbon(image: GreyImage, site: CrossingSite, which: int, width_px: float) -> Ribbon:
    """Return the surroundings of one strand within a cable width of its centre line."""
    path, other = site.paths[which], site.paths[1 - which]
    along = tangents(path, reach=4)
    normals = np.column_stack([-along[:, 1], along[:, 0]])
    aside_px = np.linspace(-0.8, 0.8, 13) * width_px
    places = path[:, None, :] + aside_px[:, None] * normals[:, None, :]
    return Ribbon(sample(image, places), aside_px, _signed_distance(places, other))


def _signed_distance(places: Points, path: Points) -> Points:
    """Return the distance of places (K, M, 2) to a path, negative on its right."""
    flat = places.reshape(-1, 2)
    squared = (flat**2).sum(axis=1)[:, None] - 2.0 * flat @ path.T + (path**2).sum(axis=1)
    nearest = squared.argmin(axis=1)
    offset, along = flat - path[nearest], tangents(path, reach=2)[nearest]
    side = along[:, 0] * offset[:, 1] - along[:, 1] * offset[:, 0]
    gaps = np.linalg.norm(offset, axis=1)
    signed: Points = np.where(side >= 0.0, gaps, -gaps)
    return signed.reshape(places.shape[:2])


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
        width_px = observation.mask.width_px
        decided = [
            decide(site, probability(self.evidence(image, observation.mask, site), self._gain))
            for site in find_sites(traces, width_px)
        ]
        return doubt_shared(decided, SHARED_WIDTHS * width_px)

    @abstractmethod
    def evidence(self, image: GreyImage, mask: CableMask, site: CrossingSite) -> float:
        """Return how much speaks for strand a on top, negative for strand b."""
