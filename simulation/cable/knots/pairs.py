"""Knots that tie two cables together, as two plane curves with over and under.

Each cable comes from its own side, and both its ends go back there: the first one's to the
left, the second one's to the right. So each may be closed over everything by itself, and the
chords meet nothing.

- Square (reef) knot: two bights hooked into each other, both legs of either on one side of
  the other's bight.
- Carrick bend, in its flat form: two loops woven over and under by turns.
- Sheet bend: the second cable comes up through the first one's bight, goes round behind both
  its legs, and in front of them is tucked under itself.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from perception.cable.topology import StrandCrossing
from perception.cable.topology.curve import self_intersections
from simulation.cable.knot_names import PairName
from simulation.cable.knots.gauss import gauss_code
from simulation.cable.knots.splines import smooth
from simulation.cable.knots.template import POINTS, WIDTHS_APART, Corners, told

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class PairTemplate:
    """A knot in two cables, drawn in the plane.

    Attributes:
        corners: For each cable, control points that a smooth curve runs through.
        over: For each cable, whether it runs on top at each visit of a crossing, its own
            crossings and those with the other cable.
        diameter: Size of the closed part, in the units of the corners.
        closest: Least distance of two crossings, in the same units.
    """

    corners: tuple[Corners, Corners]
    over: tuple[tuple[bool, ...], tuple[bool, ...]]
    diameter: float
    closest: float

    def curves_m(self, diameter_m: float, spacing_m: float) -> tuple[Floats, Floats]:
        """Return both curves at a size, evenly spaced, shape (N, 2) each."""
        size = diameter_m / self.diameter
        first, second = (smooth(np.array(line) * size, spacing_m) for line in self.corners)
        return first, second

    def least_diameter_m(self, width_m: float) -> float:
        """Return the size below which cables of a width have no room for the crossings."""
        return WIDTHS_APART * width_m * self.diameter / self.closest

    def crossings(self) -> tuple[StrandCrossing, ...]:
        """Return all crossings at diameter 1, numbered through both cables' segments."""
        first, second = self.curves_m(1.0, 1.0 / POINTS)
        a, b, turn = self_intersections(np.vstack([first, second]))
        # The segment from one cable to the other is none.
        real = (np.floor(a) != len(first) - 1) & (np.floor(b) != len(first) - 1)
        a, b, turn = a[real], b[real], turn[real]
        on_top = dict(zip(np.sort([*a, *b]), (*self.over[0], *self.over[1]), strict=True))
        found = (
            StrandCrossing(float(p), float(q), int(t), on_top[p])
            for p, q, t in zip(a, b, turn, strict=True)
        )
        return tuple(sorted(found, key=lambda crossing: crossing.first))

    def gauss_code(self) -> str:
        """Return both cables' codes, parted by a stroke."""
        return gauss_code(self.crossings(), [self._first_end()])

    def linking_number(self) -> int:
        """Return half the sum of the signs where one cable crosses the other.

        Both are closed over everything.
        """
        end = self._first_end()
        mutual = [c for c in self.crossings() if c.first < end < c.second]
        return sum(c.turn if c.first_over else -c.turn for c in mutual) // 2

    def _first_end(self) -> float:
        return len(self.curves_m(1.0, 1.0 / POINTS)[0]) - 0.5


# One of two equal bights.
_SQUARE = (
    (-5.0, 1.3), (-3.2, 0.82), (-0.98, 0.71), (-0.02, 1.14), (0.62, 1.49), (1.46, 0.87),
    (1.39, 0.0), (1.46, -0.87), (0.62, -1.49), (-0.02, -1.14), (-0.98, -0.71), (-3.2, -0.82),
    (-5.0, -1.3),
)  # fmt: skip
# One of two equal loops.
_CARRICK = (
    (-4.92, 2.16), (-3.42, 1.62), (-2.65, 1.3), (-0.98, -0.39), (-0.07, -1.96), (1.39, -2.62),
    (2.81, -1.78), (3.04, 0.0), (2.81, 1.78), (1.39, 2.62), (-0.07, 1.96), (-0.98, 0.39),
    (-2.65, -1.3), (-3.42, -1.62), (-4.92, -2.16),
)  # fmt: skip
# The bight, and what is tied round it.
_SHEET_BIGHT = (
    (-4.69, 1.1), (-2.52, 1.11), (-0.49, 1.4), (1.45, 1.61), (2.2, -0.01), (1.63, -1.28),
    (-0.29, -1.61), (-2.09, -1.12), (-4.65, -0.91),
)  # fmt: skip
_SHEET_ROUND = (
    (5.17, -0.58), (3.59, -0.58), (2.11, -0.51), (0.92, -0.31), (-0.09, 0.45), (-0.4, 1.2),
    (-1.09, 2.0), (-2.15, 1.89), (-2.5, 0.9), (-2.33, -0.15), (-2.3, -1.5), (-1.47, -2.25),
    (-0.5, -1.91), (-0.18, -1.14), (0.57, 0.07), (1.17, 1.04), (1.75, 2.1), (2.7, 3.1),
)  # fmt: skip


def _turned(line: Corners) -> Corners:
    """Return a line turned by half a turn about the origin."""
    return tuple((-x, -y) for x, y in line)


PAIRS: dict[PairName, PairTemplate] = {
    "square": PairTemplate(
        (_SQUARE, _turned(_SQUARE)), (told("OUOOUO"), told("UOUUOU")), 2.99, 1.32
    ),
    "carrick_bend": PairTemplate(
        (_CARRICK, _turned(_CARRICK)), (told("OU" * 4), told("OU" * 4)), 6.09, 2.23
    ),
    "sheet_bend": PairTemplate(
        (_SHEET_BIGHT, _SHEET_ROUND), (told("OUUOUO"), told("UOOUUOUO")), 4.70, 1.73
    ),
}
