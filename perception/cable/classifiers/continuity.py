"""Over and under by continuity: the upper strand looks the same all the way through.

Beside the upper strand the lower one dips: the upper one's dark border and its contact
shadow lie on it.
"""

from itertools import pairwise

import numpy as np

from perception.cable.classifiers.evidence import EvidenceClassifier, Ribbon, ribbon
from perception.cable.crossings import CrossingSite
from perception.cable.mask import CableMask
from perception.camera import GreyImage

# Logistic fit to rendered crossings at 4-9 px, any shadow, blur and noise; a little less, as
# other cameras differ.
DEFAULT_GAIN = 30.0
# A strand's own border is left out; distances from the other strand are in cable widths.
CORE = 0.2
FLANK = (0.35, 0.95)
FLANK_BINS = 4


class ContinuityClassifier(EvidenceClassifier):
    """Implements `CrossingClassifier` by brightness along each strand."""

    def __init__(self, gain: float = DEFAULT_GAIN) -> None:
        """Set how steeply evidence becomes belief."""
        super().__init__(gain)

    def evidence(self, image: GreyImage, mask: CableMask, site: CrossingSite) -> float:
        """Return how much deeper strand b dips than strand a, as a share of the contrast."""
        dips = [_dip(ribbon(image, site, which, mask.width_px), mask.width_px) for which in (0, 1)]
        return (dips[1] - dips[0]) / mask.contrast


def _dip(strand: Ribbon, width_px: float) -> float:
    """Return how dark a strand gets where it meets the borders of the other."""
    core = np.abs(strand.aside_px) <= CORE * width_px
    values, other = strand.values[:, core], strand.other_px[:, core] / width_px
    level = float(np.median(values[np.abs(other) < 2.0]))
    edges = np.linspace(*FLANK, FLANK_BINS + 1)
    dips = []
    for side in (-1.0, 1.0):
        bins = [values[(side * other >= a) & (side * other < b)] for a, b in pairwise(edges)]
        means = [float(found.mean()) for found in bins if found.size]
        dips.append(level - min(means, default=level))
    return float(np.mean(dips))
