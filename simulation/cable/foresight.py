"""Imagines what a pull does: the cable as it is believed to lie, moved by the cable physics.

Nothing of the simulated cell is known here. Where a strand lies on top comes from the crossings
that were seen.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from perception.cable.polyline import arc_lengths, point_at
from perception.cable.types import ImaginedHand
from simulation.cable.carrying import Carried, carry
from simulation.cable.parameters import RodParameters
from simulation.cable.rod import Rod

Floats = NDArray[np.float64]

# An ordinary cable, coarser than the cell's: its pulls end with as many crossings as those of the
# fine one, one or two in ten aside, and cost a third.
ORDINARY = RodParameters(node_spacing_m=0.015, substep_s=0.0005)
# A strand that lies over another one rises over it within so much of its length, and so high.
RISE_M, RISE_RADII = 0.015, 2.2
# The cable comes to lie before it is taken, and is looked at so long after it was let go.
LAID_S, REST_S = 0.15, 1.0


class CableForesight:
    """Implements `perception.cable.interfaces.Foresight`."""

    def __init__(self, parameters: RodParameters = ORDINARY) -> None:
        """Know what the cable and its table are made of."""
        self._parameters = parameters

    def after(
        self,
        line_m: Floats,
        over: Sequence[float],
        hands: Sequence[ImaginedHand],
    ) -> Floats | None:
        """Return how the cable should lie after hands have moved it; see `Foresight`."""
        nodes_m = raised(line_m, over, self._parameters)
        rod = Rod((nodes_m,), self._parameters)
        rod.advance(LAID_S)
        parts = [_part(rod.positions_m, hand) for hand in hands]
        if not carry(rod, parts, REST_S):
            return None
        after_m: Floats = rod.positions_m.copy()
        return after_m


def raised(line_m: Floats, over: Sequence[float], parameters: RodParameters) -> Floats:
    """Return nodes along a line on the table that rise where they lie on top, shape (M, 3).

    Args:
        line_m: On the table, shape (N, 2).
        over: Arc positions where it lies on top of another strand.
        parameters: How far nodes are apart, and how thick the cable is.
    """
    arcs_m = arc_lengths(line_m)
    count = max(round(float(arcs_m[-1]) / parameters.node_spacing_m), 4)
    at_m = np.linspace(0.0, float(arcs_m[-1]), count + 1)
    far_m = np.subtract.outer(at_m, np.asarray(over, dtype=float) * arcs_m[-1])
    rise = np.exp(-0.5 * (far_m / RISE_M) ** 2).max(axis=1, initial=0.0)
    heights_m = parameters.radius_m * (1.0 + RISE_RADII * rise)
    return np.column_stack([point_at(line_m, arcs_m, at_m), heights_m])


def _part(nodes_m: Floats, hand: ImaginedHand) -> Carried:
    node = round(hand.arc * (len(nodes_m) - 1))
    along_m = nodes_m[min(node + 2, len(nodes_m) - 1), :2] - nodes_m[max(node - 2, 0), :2]
    direction = along_m / max(float(np.linalg.norm(along_m)), 1e-9)
    return Carried(hand.role, nodes_m[node, :2].copy(), direction, hand.to_m, hand.lets_go)
