"""Over and under by continuity: the upper strand looks the same all the way through.

Beside the upper strand the lower one dips: the upper one's dark border and its contact
shadow lie on it.
"""

import numpy as np

from perception.cable.classifiers.evidence import EvidenceClassifier, along_strand, sample, sine
from perception.cable.crossings import CrossingSite
from perception.cable.mask import CableMask
from perception.camera import GreyImage

DEFAULT_GAIN = 12.0


class ContinuityClassifier(EvidenceClassifier):
    """Implements `CrossingClassifier` by brightness along each strand."""

    def __init__(self, gain: float = DEFAULT_GAIN) -> None:
        """Set how steeply evidence becomes belief."""
        super().__init__(gain)

    def evidence(self, image: GreyImage, mask: CableMask, site: CrossingSite) -> float:
        """Return how much deeper strand b dips than strand a, as a share of the contrast."""
        dips = [self._dip(image, mask, site, which) for which in (0, 1)]
        return dips[1] - dips[0]

    def _dip(self, image: GreyImage, mask: CableMask, site: CrossingSite, which: int) -> float:
        """Return how dark a strand gets where it would meet the border of the other."""
        half_px = 0.5 * mask.width_px / sine(site)
        along_px = np.linspace(0.5 * half_px, 1.7 * half_px, 9)
        aside_px = np.linspace(-0.18, 0.18, 3)[:, None] * mask.width_px
        middle = float(sample(image, site.position_px[None])[0])
        dips = []
        for way in (-1.0, 1.0):
            flank = sample(image, along_strand(site, which, way * along_px, aside_px)).mean(axis=0)
            far = along_strand(site, which, way * np.linspace(1.7, 2.3, 5) * half_px, aside_px)
            outer = float(sample(image, far).mean())
            dips.append(max(0.5 * (middle + outer) - float(flank.min()), 0.0))
        return float(np.mean(dips)) / mask.contrast
