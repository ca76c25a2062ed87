"""A knot in one cable, as a plane curve with over and under."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from perception.cable.topology import (
    Diagram,
    Strand,
    StrandCrossing,
    close_over,
    curve_crossings,
)
from simulation.cable.knots.splines import smooth

Floats = NDArray[np.float64]
Corners = tuple[tuple[float, float], ...]

# Points that a template's curve has for its diameter where it is looked at by itself.
POINTS = 150
# Neighbouring crossings are at least this many cable widths apart: strands are stiff, and
# no more than two should lie upon each other.
WIDTHS_APART = 1.7


def told(word: str) -> tuple[bool, ...]:
    """Return over and under from letters O and U."""
    return tuple(letter == "O" for letter in word)


@dataclass(frozen=True, slots=True)
class KnotTemplate:
    """An open knot, drawn in the plane.

    Attributes:
        corners: Control points that a smooth curve runs through, in units of its own.
        over: For each visit of a crossing along the curve, whether it runs on top.
        diameter: Size of the closed part, in the same units.
        closest: Least distance of two of its crossings, in the same units.
        closes_to: The knot it is once its ends are joined over everything, as D. Rolfsen's
            table (Knots and Links, 1976) names it.
    """

    corners: Corners
    over: tuple[bool, ...]
    diameter: float
    closest: float
    closes_to: str

    @property
    def crossings(self) -> int:
        """How often it crosses itself."""
        return len(self.over) // 2

    def first_over(
        self, crossings: Sequence[StrandCrossing], over: Sequence[bool] = ()
    ) -> tuple[bool, ...]:
        """Return for each crossing of a curve laid after the template who is on top.

        Args:
            crossings: The curve's crossings with itself.
            over: For each visit whether it runs on top, where not as in the template.
        """
        arcs = sorted(arc for c in crossings for arc in (c.first, c.second))
        over = over or self.over
        return tuple(over[arcs.index(crossing.first)] for crossing in crossings)

    def curve_m(self, diameter_m: float, spacing_m: float) -> Floats:
        """Return the curve at a size, evenly spaced, shape (N, 2)."""
        return smooth(np.array(self.corners) * (diameter_m / self.diameter), spacing_m)

    def least_diameter_m(self, width_m: float) -> float:
        """Return the size below which a cable of a width has no room for its crossings."""
        return WIDTHS_APART * width_m * self.diameter / self.closest

    def strand(self, over: Sequence[bool] = ()) -> Strand:
        """Return its curve with its crossings, of diameter 1.

        Args:
            over: For each visit whether it runs on top, where not as in the template.
        """
        flat = _flat(self)
        first_over = self.first_over(flat.crossings, over)
        return Strand(
            flat.points,
            tuple(
                replace(crossing, first_over=on_top)
                for crossing, on_top in zip(flat.crossings, first_over, strict=True)
            ),
        )

    def diagram(self, over: Sequence[bool] = ()) -> Diagram:
        """Return its diagram, its ends joined over everything; `over` as for `strand`."""
        return close_over(self.strand(over))


@cache
def _flat(template: KnotTemplate) -> Strand:
    """Return a template's curve of diameter 1 and where it crosses itself, over or under."""
    curve = template.curve_m(1.0, 1.0 / POINTS)
    return curve_crossings(np.column_stack([curve, np.zeros(len(curve))]))
