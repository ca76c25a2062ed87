"""Every likely way that the crossings of one trace may lie, each with its knot.

Crossings are right independently of each other, each with its own probability. The likeliest
combinations are listed, and each gives a diagram whose knot is told exactly.
"""

import heapq
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from perception.cable.crossings import strand_of
from perception.cable.topology import Diagram, close_over, knot_type
from perception.cable.types import Crossing, Reading

# Combinations are listed until so much of the probability is covered, or so many are seen.
COVERED = 0.999
MOST_COMBINATIONS = 96


@dataclass(frozen=True, slots=True, eq=False)
class Outcomes:
    """Combinations of one reading's crossings.

    Attributes:
        crossings: The crossings in the order of the trace.
        flipped: Which crossings are the other way round, shape (K, crossings).
        weights: Probability of each combination, adding up to 1, shape (K,).
        knots: Name of the knot of each combination.
    """

    crossings: tuple[Crossing, ...]
    flipped: NDArray[np.bool_]
    weights: NDArray[np.float64]
    knots: tuple[str, ...]


def outcomes(reading: Reading, most: int = MOST_COMBINATIONS) -> Outcomes:
    """List the combinations of a reading's crossings.

    Args:
        reading: A trace with its crossings.
        most: How many combinations are listed.
    """
    own = sorted(reading.crossings, key=lambda c: min(c.arc_over, c.arc_under))
    index = own[0].trace_over if own else 0
    diagram = close_over(strand_of(reading.trace, index, own))
    # What a crossing parts in two cannot be knotted together, whoever is on top there.
    matter = [k for k in range(len(own)) if not _parts(diagram, k)]
    flips, weights = [], []
    for chosen, weight in likeliest_flips([own[k].probability for k in matter], most):
        flips.append(frozenset(matter[k] for k in chosen))
        weights.append(weight)
    return Outcomes(
        tuple(own),
        np.array([[k in chosen for k in range(len(own))] for chosen in flips], dtype=bool),
        np.array(weights) / sum(weights),
        tuple(_knot(diagram.swapped(chosen)) for chosen in flips),
    )


@lru_cache(maxsize=4096)
def _knot(diagram: Diagram) -> str:
    return knot_type(diagram)


def _parts(diagram: Diagram, crossing: int) -> bool:
    """Say whether a crossing is all that joins what lies between its visits to the rest."""
    first = diagram.visits.index(crossing)
    inside = diagram.visits[first + 1 : diagram.visits.index(crossing, first + 1)]
    return len(inside) == 2 * len(set(inside))


def likeliest_flips(
    probabilities: Sequence[float], most: int = MOST_COMBINATIONS
) -> Iterator[tuple[tuple[int, ...], float]]:
    """Yield sets of crossings that are the other way round, the likeliest first.

    Args:
        probabilities: Belief in each crossing as it is, in [0.5, 1].
        most: How many sets are listed.

    Yields:
        Indices of the crossings to flip, and the probability of exactly that combination.
    """
    costs = [math.log(p / max(1.0 - p, 1e-12)) for p in probabilities]
    order = sorted(range(len(costs)), key=lambda k: costs[k])
    base = math.prod(probabilities)
    covered, count = 0.0, 0
    # Subsets by growing total cost: extend a subset, or move its last member on by one.
    heap: list[tuple[float, tuple[int, ...]]] = [(0.0, ())]
    while heap and covered < COVERED and count < most:
        cost, chosen = heapq.heappop(heap)
        weight = base * math.exp(-cost)
        yield tuple(order[k] for k in chosen), weight
        covered, count = covered + weight, count + 1
        following = chosen[-1] + 1 if chosen else 0
        if following < len(order):
            step = costs[order[following]]
            heapq.heappush(heap, (cost + step, (*chosen, following)))
            if chosen:
                moved = cost - costs[order[chosen[-1]]] + step
                heapq.heappush(heap, (moved, (*chosen[:-1], following)))
