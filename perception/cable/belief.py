"""From uncertain traces and crossings to P(knotted) and P(knot).

A cable may be read in several ways, each of which has crossings that may be either way round.
Every likely combination gives a diagram whose knot is told exactly, and probabilities add up.
What is not read, or read only in part, is unknown.
"""

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence

from perception.cable.outcomes import MOST_COMBINATIONS, Outcomes, outcomes
from perception.cable.topology.names import UNKNOT, UNKNOWN
from perception.cable.types import COMPLETENESS, Crossing, KnotBelief, Reading, Trace

NOTHING_KNOWN = 0.5
Chances = Mapping[str, float]
FEWEST_COMBINATIONS = 8


def knotted_probability(traces: Sequence[Trace], crossings: Sequence[Crossing]) -> float:
    """Return the belief that at least one trace is knotted.

    A trace that is unsure or incomplete pulls the belief towards one half; without any trace
    nothing is known.
    """
    return any_knotted([[reading_of(trace, k, crossings)] for k, trace in enumerate(traces)])


def any_knotted(cables: Sequence[Sequence[Reading]]) -> float:
    """Return the belief that at least one cable is knotted.

    Args:
        cables: For each cable the ways to read it; what their probabilities lack to 1 is the
            belief in none of them.
    """
    if not cables:
        return NOTHING_KNOWN
    return 1.0 - math.prod(1.0 - knotted_share(chances(readings)) for readings in cables)


def knot_types(readings: Sequence[Reading]) -> tuple[KnotBelief, ...]:
    """Return the beliefs in the knots that one cable may hold, the likeliest first."""
    ordered = sorted(chances(readings).items(), key=lambda item: (-item[1], item[0]))
    return tuple(KnotBelief(name, probability) for name, probability in ordered if probability > 0)


def reading_of(trace: Trace, index: int, crossings: Sequence[Crossing]) -> Reading:
    """Return the reading of one trace out of several.

    Args:
        trace: The trace.
        index: Its number in the crossings.
        crossings: Crossings of all traces.
    """
    own = tuple(c for c in crossings if c.trace_over == index and c.trace_under == index)
    return Reading(trace, own)


def diagram_probability(trace: Trace, index: int, crossings: Sequence[Crossing]) -> float:
    """Return the belief that a trace is knotted, given that it follows the cable."""
    return knotted_share(told(outcomes(reading_of(trace, index, crossings))))


def chances(readings: Sequence[Reading]) -> Chances:
    """Return the probability of each knot of one cable, `unknown` among them."""
    told_by = [told(listed) for listed in listings(readings)]
    sure = [sureness(reading) for reading in readings]
    rest = max(0.0, 1.0 - math.fsum(sure))
    return mixed([*zip(sure, told_by, strict=True), (rest, {UNKNOWN: 1.0})])


def mixed(parts: Iterable[tuple[float, Chances]]) -> Chances:
    """Return the sum of probabilities, each times its weight."""
    total: defaultdict[str, float] = defaultdict(float)
    for weight, part in parts:
        for name, probability in part.items():
            total[name] += weight * probability
    return total


def listings(readings: Sequence[Reading]) -> list[Outcomes]:
    """List each reading's combinations, of likelier readings more."""
    return [
        outcomes(reading, max(FEWEST_COMBINATIONS, round(MOST_COMBINATIONS * sureness(reading))))
        for reading in readings
    ]


def sureness(reading: Reading) -> float:
    """Return how much of the belief in the whole cable's knot is a reading's."""
    return reading.trace.probability * COMPLETENESS[reading.trace.end]


def told(listed: Outcomes) -> Chances:
    """Return the probability of each knot, given that a reading is right."""
    rows = zip(listed.weights.tolist(), listed.knots, strict=True)
    return mixed((weight, {name: 1.0}) for weight, name in rows)


def knotted_share(knots: Chances) -> float:
    """Return P(knotted) from the probabilities of all knots; the unknown counts half."""
    unknown, unknotted = knots.get(UNKNOWN, 0.0), knots.get(UNKNOT, 0.0)
    return max(0.0, 1.0 - unknotted - unknown * (1.0 - NOTHING_KNOWN))
