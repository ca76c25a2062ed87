"""Over and under by borders: the upper strand's borders run through, the lower one's stop.

Inside a crossing, the upper strand's two border lines lie on the lower strand and are darker
than it (shading and contact shadow), while the lower strand's border lines would run over the
upper strand's bright body, where nothing is to be seen.
"""

import numpy as np

from perception.cable.classifiers.evidence import EvidenceClassifier, along_strand, sample, sine
from perception.cable.crossings import CrossingSite
from perception.cable.mask import CableMask
from perception.camera import GreyImage

DEFAULT_GAIN = 14.0


class EdgeClassifier(EvidenceClassifier):
    """Implements `CrossingClassifier` by the border lines of both strands."""

    def __init__(self, gain: float = DEFAULT_GAIN) -> None:
        """Set how steeply evidence becomes belief."""
        super().__init__(gain)

    def evidence(self, image: GreyImage, mask: CableMask, site: CrossingSite) -> float:
        """Return how much darker strand a's border lines are than strand b's."""
        borders = [self._border(image, mask, site, which) for which in (0, 1)]
        return (borders[1] - borders[0]) / mask.contrast

    def _border(self, image: GreyImage, mask: CableMask, site: CrossingSite, which: int) -> float:
        """Return the grey value of a strand's border lines within the other strand's core."""
        half_px = 0.5 * mask.width_px
        core_px = 0.5 * half_px / sine(site)
        lines = []
        for side in (-1.0, 1.0):
            aside_px = side * np.linspace(0.7, 1.15, 4)[:, None] * half_px
            # Where strands cross obliquely, the core is shifted along the border line.
            shift_px = self._shift(site, which) * aside_px
            along_px = np.linspace(-core_px, core_px, 5) + shift_px
            values = sample(image, along_strand(site, which, along_px, aside_px))
            lines.append(float(values.mean(axis=1).min()))
        return float(np.mean(lines))

    def _shift(self, site: CrossingSite, which: int) -> float:
        """Return how far along a strand the other one moves for each pixel beside it."""
        own, other = site.directions[which], site.directions[1 - which]
        beside = float(own[0] * other[1] - own[1] * other[0])
        along = float(own @ other)
        return float(np.clip(along / beside, -3.0, 3.0)) if beside else 0.0
