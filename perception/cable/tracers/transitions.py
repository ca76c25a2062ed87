"""The most likely ways to thread cables through all junctions at once.

Choosing one option at every junction (a transition system, in the words of Euler tours)
splits the graph into strands. Costs of junctions add up; what only shows when the whole is
seen is added afterwards: a cable has two ends, so strands that close on themselves are wrong.
"""

import heapq
import math
from collections.abc import Sequence
from dataclasses import dataclass

from perception.cable.graph import Arm
from perception.cable.tracers.junctions import Junction, Option

Partners = dict[Arm, Arm]


@dataclass(frozen=True, slots=True)
class ThreadingConfig:
    """Settings of the search over all junctions; costs in nats.

    Attributes:
        most: How many of the cheapest choices are looked at.
        window: Choices this much worse than the best are left out.
        ring_cost: Cost of a strand that closes on itself.
    """

    most: int = 600
    window: float = 25.0
    ring_cost: float = 14.0


@dataclass(frozen=True, slots=True)
class Threading:
    """One way to thread the cables.

    Attributes:
        cost: Negative logarithm of its likelihood, up to a constant.
        partners: Arm to arm across each junction; an arm that ends there is missing.
    """

    cost: float
    partners: Partners


def best_threadings(
    junctions: Sequence[Junction], config: ThreadingConfig | None = None
) -> list[Threading]:
    """Return the cheapest threadings, best first."""
    config = config or ThreadingConfig()
    fixed, open_ones = _split(junctions, config.window)
    base = _partners(fixed)
    threadings = []
    for cost, chosen in _cheapest(open_ones, config):
        partners = base | _partners(
            [junction.options[k] for junction, k in zip(open_ones, chosen, strict=True)]
        )
        threadings.append(Threading(cost + config.ring_cost * _rings(partners), partners))
    return sorted(threadings, key=lambda threading: threading.cost)


def _split(junctions: Sequence[Junction], window: float) -> tuple[list[Option], list[Junction]]:
    """Return options that have no rival, and junctions that leave a choice."""
    fixed, open_ones = [], []
    for junction in junctions:
        options = junction.options
        if len(options) > 1 and options[1].cost < options[0].cost + window:
            open_ones.append(junction)
        else:
            fixed.append(options[0])
    return fixed, open_ones


def _cheapest(
    junctions: Sequence[Junction], config: ThreadingConfig
) -> list[tuple[float, tuple[int, ...]]]:
    """Return the cheapest choices of one option a junction, as excess over the best."""
    sums: list[tuple[float, tuple[int, ...]]] = [(0.0, ())]
    for junction in junctions:
        best = junction.options[0].cost
        extended = (
            (total + option.cost - best, (*chosen, k))
            for total, chosen in sums
            for k, option in enumerate(junction.options)
            if total + option.cost - best <= config.window
        )
        sums = heapq.nsmallest(config.most, extended)
    return sums


def _partners(options: Sequence[Option]) -> Partners:
    partners: Partners = {}
    for option in options:
        for a, b in option.pairs:
            partners[a], partners[b] = b, a
    return partners


def _rings(partners: Partners) -> int:
    """Return how many strands close on themselves."""
    seen: set[Arm] = set()
    for arm in partners:
        if (arm[0], 1 - arm[1]) not in partners:
            walk(partners, arm, seen)
    rings = 0
    for arm in partners:
        if arm not in seen:
            walk(partners, arm, seen)
            rings += 1
    return rings


def walk(partners: Partners, leaving: Arm, seen: set[Arm] | None = None) -> list[Arm]:
    """Return the arms through which a strand leaves its edges, starting with `leaving`.

    It stops where a strand ends, or comes back to where it began. Both arms of every pair
    that is passed are added to `seen`.
    """
    arms, seen = [leaving], set() if seen is None else seen
    while (entered := partners.get(arms[-1])) is not None:
        if arms[-1] in seen:
            break
        seen |= {arms[-1], entered}
        arms.append((entered[0], 1 - entered[1]))
    return arms


def strand_probabilities(
    threadings: Sequence[Threading], leaving: Arm
) -> list[tuple[tuple[Arm, ...], float]]:
    """Return the strands that leave an edge through one arm with their probabilities."""
    best = threadings[0].cost
    weights: dict[tuple[Arm, ...], float] = {}
    for threading in threadings:
        strand = tuple(walk(threading.partners, leaving))
        weights[strand] = weights.get(strand, 0.0) + math.exp(best - threading.cost)
    total = sum(weights.values())
    return sorted(
        ((strand, weight / total) for strand, weight in weights.items()),
        key=lambda item: -item[1],
    )
