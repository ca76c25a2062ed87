"""Over and under by borders: the upper strand's borders run through, the lower one's stop.

Inside a crossing, the upper strand's two border lines lie on the lower strand and are darker
than it (shading and contact shadow), while the lower strand's border lines would run over the
upper strand's bright body, where nothing is to be seen.
"""

import numpy as np

from perception.cable.classifiers.evidence import EvidenceClassifier, Ribbon, ribbon
from perception.cable.crossings import CrossingSite
from perception.cable.mask import CableMask
from perception.camera import GreyImage

# Logistic fit to rendered crossings at 4-9 px, any shadow, blur and noise; a little less, as
# other cameras differ.
DEFAULT_GAIN = 35.0
# In cable widths: where a strand's border is, and which part of the other strand is its core.
BORDER = (0.35, 0.75)
CORE = 0.3


class EdgeClassifier(EvidenceClassifier):
    """Implements `CrossingClassifier` by the border lines of both strands."""

    def __init__(self, gain: float = DEFAULT_GAIN) -> None:
        """Set how steeply evidence becomes belief."""
        super().__init__(gain)

    def evidence(self, image: GreyImage, mask: CableMask, site: CrossingSite) -> float:
        """Return how much darker strand a's border lines are than strand b's."""
        borders = [
            _border(ribbon(image, site, which, mask.width_px), mask.width_px) for which in (0, 1)
        ]
        return (borders[1] - borders[0]) / mask.contrast


def _border(strand: Ribbon, width_px: float) -> float:
    """Return the grey value of a strand's darkest border lines on the other strand's core."""
    on_other = np.abs(strand.other_px) < CORE * width_px
    lines = []
    for side in (-1.0, 1.0):
        distance = side * strand.aside_px / width_px
        columns = np.flatnonzero((distance >= BORDER[0]) & (distance <= BORDER[1]))
        means = [
            float(strand.values[on_other[:, column], column].mean())
            for column in columns
            if on_other[:, column].any()
        ]
        lines.append(min(means, default=float(np.median(strand.values))))
    return float(np.mean(lines))
