"""What is true about a simulated cable; for scoring alone, no skill and no tree may read it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from perception.cable.topology import (
    Knottedness,
    StrandCrossing,
    classify_curve,
    curve_crossings,
)

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class CableTruth:
    """How a cable ended.

    Attributes:
        untangled: Whether it is proved to be unknotted when its ends are joined over everything.
        crossings: How often it crosses itself, seen from above.
    """

    untangled: bool
    crossings: int


def cable_truth(nodes_m: Floats) -> CableTruth:
    """Score a centre line, shape (N, 3), world frame [m]."""
    verdict = classify_curve(np.asarray(nodes_m))
    return CableTruth(verdict.state is Knottedness.UNKNOT, verdict.crossings)


def centre_line_crossings(nodes_m: Floats) -> tuple[StrandCrossing, ...]:
    """Return where a centre line crosses itself from above, over and under by height."""
    return curve_crossings(np.asarray(nodes_m)).crossings
