"""From uncertain traces and crossings to P(knotted).

Every crossing may be the other way round. The likeliest combinations of all crossings are
listed, each gives a diagram that is classified exactly, and their probabilities add up.
"""

import heapq
import math
from collections.abc import Iterator, Sequence
from functools import lru_cache

from perception.cable.crossings import strand_of
from perception.cable.topology import Diagram, Knottedness, classify_diagram, close_over
from perception.cable.types import Crossing, Trace, TraceEnd

# Combinations are listed until so much of the probability is covered, or so many are seen.
COVERED = 0.999
MOST_COMBINATIONS = 96
# How much a trace that ends like this can tell about the whole cable.
COMPLETENESS = {
    TraceEnd.ENDPOINT: 1.0,
    TraceEnd.EDGE: 0.6,
    TraceEnd.LOST: 0.4,
    TraceEnd.RETRACE: 0.2,
}
NOTHING_KNOWN = 0.5


def knotted_probability(traces: Sequence[Trace], crossings: Sequence[Crossing]) -> float:
    """Return the belief that at least one trace is knotted.

    A trace that is unsure or incomplete pulls the belief towards one half; without any trace
    nothing is known.
    """
    if not traces:
        return NOTHING_KNOWN
    none_knotted = 1.0
    for index, trace in enumerate(traces):
        seen = diagram_probability(trace, index, crossings)
        sure = trace.probability * COMPLETENESS[trace.end]
        none_knotted *= 1.0 - (sure * seen + (1.0 - sure) * NOTHING_KNOWN)
    return 1.0 - none_knotted


def diagram_probability(trace: Trace, index: int, crossings: Sequence[Crossing]) -> float:
    """Return the belief that a trace is knotted, given that it follows the cable."""
    own = [c for c in crossings if c.trace_over == index and c.trace_under == index]
    own.sort(key=lambda crossing: min(crossing.arc_over, crossing.arc_under))
    diagram = close_over(strand_of(trace, index, own))
    knotted = seen = 0.0
    for flipped, weight in likeliest_flips([crossing.probability for crossing in own]):
        knotted += weight * _knotted(diagram.swapped(frozenset(flipped)))
        seen += weight
    return knotted / seen


@lru_cache(maxsize=4096)
def _knotted(diagram: Diagram) -> float:
    answers = {Knottedness.UNKNOT: 0.0, Knottedness.KNOTTED: 1.0, Knottedness.UNDECIDED: 0.5}
    return answers[classify_diagram(diagram).state]


def likeliest_flips(probabilities: Sequence[float]) -> Iterator[tuple[tuple[int, ...], float]]:
    """Yield sets of crossings that are the other way round, the likeliest first.

    Args:
        probabilities: Belief in each crossing as it is, in [0.5, 1].

    Yields:
        Indices of the crossings to flip, and the probability of exactly that combination.
    """
    costs = [math.log(p / max(1.0 - p, 1e-12)) for p in probabilities]
    order = sorted(range(len(costs)), key=lambda k: costs[k])
    base = math.prod(probabilities)
    covered, count = 0.0, 0
    # Subsets by growing total cost: extend a subset, or move its last member on by one.
    heap: list[tuple[float, tuple[int, ...]]] = [(0.0, ())]
    while heap and covered < COVERED and count < MOST_COMBINATIONS:
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
