"""Which of several pulls leaves the cable best, as far as that can be imagined."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from perception.cable.interfaces import Foresight
from perception.cable.polyline import arc_lengths, point_at
from perception.cable.topology import classify_curve
from robots.interfaces import Floats
from skills.cable.laying_out import STEP_M, Ends, Pull, crossings_of, tangle_cost

# In crossings: one of those that a knot cannot do without.
KNOT_COST = 3.0


@dataclass(frozen=True, slots=True, eq=False)
class Imagined:
    """What should come of a pull.

    Attributes:
        pull: Index of the pull.
        ends: Where the hands go.
        crossings: How many crossings should be left.
        cost: How bad it is to leave the cable so.
    """

    pull: int
    ends: Ends
    crossings: int
    cost: float


def best_imagined(
    foresight: Foresight,
    pulls: Sequence[tuple[Pull, Sequence[Ends]]],
    over: Sequence[float],
) -> list[Imagined]:
    """Return pulls to places, those first that should leave the cable best.

    Args:
        foresight: Imagines them.
        pulls: What is held, and the places that both hands might go to.
        over: Arc positions where the cable lies on top of itself.
    """
    return sorted(_imagined(foresight, pulls, over), key=lambda one: one.cost)


def _imagined(
    foresight: Foresight,
    pulls: Sequence[tuple[Pull, Sequence[Ends]]],
    over: Sequence[float],
) -> Iterator[Imagined]:
    for number, (pull, places) in enumerate(pulls):
        for ends in places:
            nodes_m = foresight.after(pull.line_m, over, pull.hands(ends))
            if nodes_m is not None:
                crossings = crossings_of(nodes_m[:, :2])
                yield Imagined(number, ends, crossings, outcome_cost(nodes_m))


def outcome_cost(nodes_m: Floats) -> float:
    """Return how bad it is when a cable lies like this: its knot, and how hard it is to see.

    Args:
        nodes_m: Points along it, shape (N, 3).
    """
    arcs_m = arc_lengths(nodes_m)
    steps = max(round(float(arcs_m[-1]) / STEP_M), 1)
    seen_m = point_at(nodes_m[:, :2], arcs_m, np.linspace(0.0, float(arcs_m[-1]), steps + 1))
    return KNOT_COST * classify_curve(nodes_m).reduced_crossings + tangle_cost(seen_m)
