"""Which of several pulls leaves the cable best, as far as that can be imagined."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from perception.cable.interfaces import Foresight
from perception.cable.polyline import arc_lengths, point_at
from perception.cable.topology import classify_curve
from robots.interfaces import Floats
from skills.cable.laying_out import STEP_M, Ends, Pull, crossings_of, tangle_cost

# In crossings: one of those that a knot cannot do without, and a metre of tail left to draw.
# Without the latter a bowline with tails of 1 m was pulled to and fro; twice as much made bundles.
KNOT_COST, TAIL_COST = 3.0, 10.0
# Cable so near to where a hand has gone lies in it.
IN_HAND_M = 0.03


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
                cost = outcome_cost(nodes_m, tail_left_m(pull, ends, nodes_m))
                yield Imagined(number, ends, crossings, cost)


def tail_left_m(pull: Pull, ends: Ends, nodes_m: Floats) -> float:
    """Return how much of the tail is still to be drawn after a pull.

    Args:
        pull: What was held.
        ends: Where the hands have gone.
        nodes_m: Points along the cable then, shape (N, 3).
    """
    if not pull.slides(ends):
        return pull.left_m(ends)
    gaps_m = np.linalg.norm(nodes_m[:, :2] - ends[0], axis=1)
    node = int(gaps_m.argmin())
    # Where no cable lies in the first hand, its end has slipped through.
    return float(arc_lengths(nodes_m)[node]) if gaps_m[node] < IN_HAND_M else 0.0


def outcome_cost(nodes_m: Floats, tail_m: float) -> float:
    """Return how bad it is when a cable lies like this: its knot, and how hard it is to see.

    Args:
        nodes_m: Points along it, shape (N, 3).
        tail_m: How much of the tail is still to be drawn out of the knot, if there is one.
    """
    arcs_m = arc_lengths(nodes_m)
    steps = max(round(float(arcs_m[-1]) / STEP_M), 1)
    seen_m = point_at(nodes_m[:, :2], arcs_m, np.linspace(0.0, float(arcs_m[-1]), steps + 1))
    knot = classify_curve(nodes_m).reduced_crossings
    return (KNOT_COST * knot + TAIL_COST * tail_m if knot else 0.0) + tangle_cost(seen_m)
