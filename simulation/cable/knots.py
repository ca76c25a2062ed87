"""Knots as plane curves with over and under: the templates that configurations are laid from."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from perception.cable.topology import StrandCrossing

Floats = NDArray[np.float64]
KnotName = Literal["none", "overhand", "figure_8"]
KNOT_NAMES: tuple[KnotName, ...] = get_args(KnotName)


@dataclass(frozen=True, slots=True)
class KnotTemplate:
    """An open knot, drawn in the plane.

    Attributes:
        corners: Control points that a smooth curve runs through, in units of its own.
        over: For each visit of a crossing along the curve, whether it runs on top.
        diameter: Size of the closed part, in the same units.
    """

    corners: tuple[tuple[float, float], ...]
    over: tuple[bool, ...]
    diameter: float

    @property
    def crossings(self) -> int:
        """How often it crosses itself."""
        return len(self.over) // 2

    def first_over(self, crossings: Sequence[StrandCrossing]) -> tuple[bool, ...]:
        """Return for each crossing of a curve laid after the template who is on top."""
        arcs = sorted(arc for c in crossings for arc in (c.first, c.second))
        return tuple(self.over[arcs.index(crossing.first)] for crossing in crossings)

    def curve_m(self, diameter_m: float, spacing_m: float) -> Floats:
        """Return the curve at a size, evenly spaced, shape (N, 2)."""
        return smooth(np.array(self.corners) * (diameter_m / self.diameter), spacing_m)


def smooth(corners_m: Floats, spacing_m: float) -> Floats:
    """Return points evenly spaced on a centripetal cubic spline through corners, shape (N, D)."""
    chords = np.linalg.norm(np.diff(corners_m, axis=0), axis=1)
    knots = np.concatenate([[0.0], np.cumsum(np.sqrt(chords))])
    dense = CubicSpline(knots, corners_m)(np.linspace(0.0, knots[-1], 40 * len(knots)))
    return evenly(dense, spacing_m)


def evenly(points_m: Floats, spacing_m: float) -> Floats:
    """Return points of a polyline at equal arc lengths, as near to the spacing as fits."""
    steps_m = np.linalg.norm(np.diff(points_m, axis=0), axis=1)
    arcs_m = np.concatenate([[0.0], np.cumsum(steps_m)])
    wanted = np.linspace(0.0, arcs_m[-1], max(2, round(arcs_m[-1] / spacing_m) + 1))
    return np.column_stack([np.interp(wanted, arcs_m, axis) for axis in points_m.T])


def _mirrored(
    half: Iterable[tuple[float, float]], y_sign: float
) -> tuple[tuple[float, float], ...]:
    """Continue a half curve from the origin backwards: x turns over, y by `y_sign`."""
    half = tuple(half)
    return (*((-x, y_sign * y) for x, y in reversed(half)), (0.0, 0.0), *half)


# The trefoil as it is tied in a rope: two lobes, mirrored left and right.
_OVERHAND_HALF = (
    (1.0, -0.25), (1.75, -1.1), (2.0, -2.2), (1.5, -2.9), (0.65, -2.6),
    (-0.4, -1.5), (-1.3, -0.5), (-2.2, 0.4), (-3.2, 1.0),
)  # fmt: skip
# The figure-eight: an S through the middle, turned into itself by half a turn.
_FIGURE_8_HALF = (
    (0.75, -0.9), (1.6, -1.5), (2.45, -1.25), (2.7, -0.2), (2.35, 1.2), (1.6, 2.3),
    (0.4, 2.65), (-0.7, 1.9), (-1.5, 0.5), (-2.4, -0.7), (-3.4, -1.5),
)  # fmt: skip

# Both are alternating knots: over and under take turns.
TEMPLATES: dict[KnotName, KnotTemplate] = {
    "overhand": KnotTemplate(_mirrored(_OVERHAND_HALF, 1.0), (True, False) * 3, 4.0),
    "figure_8": KnotTemplate(_mirrored(_FIGURE_8_HALF, -1.0), (True, False) * 4, 5.4),
}
