"""Which of several pulls leaves the cable best, as far as that can be imagined."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from statistics import fmean

import numpy as np

from perception.cable.interfaces import Foresight
from perception.cable.polyline import arc_lengths, point_at
from perception.cable.topology import Knottedness, classify_curve
from robots.interfaces import Floats
from skills.cable.laying_out import STEP_M, Ends, Pull, crossings_of, tangle_cost

# In crossings: that there is a knot, and a metre of tail that is left to draw out of it. A pull
# draws some 0.4 m and takes ten seconds, about as long as to see through ten crossings more.
KNOT_COST, TAIL_COST = 5.0, 20.0
# Hands take hold so much farther along or back than they are told to. What a pull leaves depends
# on little things: so many of the best are imagined with these grasps too, and the mean counts.
MISSES_M, MOST_AGAIN = (0.01, -0.01), 3
# A tail is measured in steps of so many nodes; less cable than this has no knot.
STRIDES, LEAST_NODES = (32, 8, 2), 8


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
    first = _ranked(_imagined(foresight, pulls, over))
    again = [_with_misses(foresight, pulls[one.pull][0], one, over) for one in first[:MOST_AGAIN]]
    return _ranked(again) + first[MOST_AGAIN:]


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


def _with_misses(
    foresight: Foresight, pull: Pull, one: Imagined, over: Sequence[float]
) -> Imagined:
    """Return what should come of a pull with the mean cost of hands that take hold nearby."""
    nearby = [
        (replace(pull, cage_m=pull.cage_m + miss_m, pinch_m=pull.pinch_m + miss_m), [one.ends])
        for miss_m in MISSES_M
    ]
    costs = [other.cost for other in _imagined(foresight, nearby, over)]
    return replace(one, cost=fmean([one.cost, *costs]))


def _ranked(found: Iterable[Imagined]) -> list[Imagined]:
    return sorted(found, key=lambda one: one.cost)


def outcome_cost(nodes_m: Floats) -> float:
    """Return how bad it is when a cable lies like this: its knot, and how hard it is to see.

    Args:
        nodes_m: Points along it, shape (N, 3).
    """
    arcs_m = arc_lengths(nodes_m)
    steps = max(round(float(arcs_m[-1]) / STEP_M), 1)
    seen_m = point_at(nodes_m[:, :2], arcs_m, np.linspace(0.0, float(arcs_m[-1]), steps + 1))
    tail_m = shorter_tail_m(nodes_m)
    return (0.0 if tail_m is None else KNOT_COST + TAIL_COST * tail_m) + tangle_cost(seen_m)


def shorter_tail_m(nodes_m: Floats) -> float | None:
    """Return how much cable must be drawn out of a knot at least to undo it; None for no knot.

    Args:
        nodes_m: Points along the cable, shape (N, 3).
    """
    if not _is_knotted(nodes_m):
        return None
    tails_m = []
    for line_m in (nodes_m, nodes_m[::-1]):
        free = _free_nodes(line_m)
        tails_m.append(float(arc_lengths(line_m[: free + 1])[-1]))
    return min(tails_m)


def _free_nodes(nodes_m: Floats) -> int:
    """Return about how many nodes at the beginning can be cut off and leave the knot."""
    free = 0
    for step in STRIDES:
        while free + step < len(nodes_m) - LEAST_NODES and _is_knotted(nodes_m[free + step :]):
            free += step
    return free


def _is_knotted(nodes_m: Floats) -> bool:
    return classify_curve(nodes_m).state is not Knottedness.UNKNOT
