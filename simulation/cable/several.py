"""Several cables at rest on one table, across each other, two of them tied together or not."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations, pairwise

import numpy as np
from numpy.typing import NDArray

from executive.core.errors import InputError
from perception.cable.topology.links import Linkedness
from simulation.cable.configurations import (
    Lines,
    Polynomial,
    ends_in_sight,
    is_tied,
    polynomial_of,
    product,
    rest,
    settle_all,
)
from simulation.cable.heights import lift_over
from simulation.cable.knot_names import KnotName, PairName
from simulation.cable.knots import PAIRS, TEMPLATES
from simulation.cable.layout import LayoutRules, grow_end
from simulation.cable.parameters import RodParameters
from simulation.cable.plans import (
    LIFT_RADII,
    NODES_APART,
    SPRING_BACK_M,
    place_core,
    shrunk,
    turned,
)
from simulation.cable.rules import ConfigurationRules
from simulation.cable.tiers import RULES
from simulation.cable.truth import crossings_of, linkedness, rings_of

Floats = NDArray[np.float64]
Span = tuple[int, int]

# How many plans are drawn before giving up: most get stuck, and cost a few hundredths of a second.
PLANS = 600
# Most crossings of an end with anything that is there already.
MOST_OF_AN_END = 2


@dataclass(frozen=True, slots=True)
class CableOrder:
    """One of several cables.

    Attributes:
        knot: What is tied into it.
        length_m: How long it is.
    """

    knot: KnotName = "none"
    length_m: float = 1.5


@dataclass(frozen=True, slots=True)
class Tie:
    """How two cables are tied together, if they are.

    Attributes:
        linked: Whether they are linked once each is closed by itself.
        rings: Alexander polynomials of the rings that both make together.
        alone: That of the rings if each cable had but its own knots.
    """

    linked: Linkedness
    rings: tuple[Polynomial, ...]
    alone: Polynomial

    @property
    def apart(self) -> bool:
        """Whether nothing speaks for a tie."""
        return self.linked is Linkedness.UNLINKED and self.alone in self.rings


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """Cables in the plane before they settle.

    Attributes:
        lines: Shape (N_k, 2) each [m].
        spans: First and last node of each one's knot, or of what is tied to another cable.
    """

    lines: Lines
    spans: tuple[Span, ...]


def several_cables(
    orders: Sequence[CableOrder],
    rng: np.random.Generator,
    tied: PairName | None = None,
    parameters: RodParameters | None = None,
    rules: ConfigurationRules = RULES,
) -> Lines:
    """Return cables at rest, some of them across others, no two tied together but by `tied`.

    Args:
        orders: The cables.
        rng: Source of all randomness: an equal state gives equal cables.
        tied: What ties the first two together; they have no other knots then.
        parameters: What they are made of.
        rules: Where and how they lie.

    Returns:
        Node positions of each [m], world frame, shape (N_k, 3).

    Raises:
        InputError: They cannot be laid.
    """
    parameters = parameters or RodParameters()
    for _ in range(PLANS):
        plan = _draw(orders, tied, rng, parameters, rules)
        if plan is None:
            continue
        lifted = _raise_over(plan, orders, tied, rng, parameters)
        ties = _ties(lifted)
        if not (_meet(plan) and _are_tied(lifted, plan, orders) and _as_asked(ties, tied)):
            continue
        lines_m = rest(settle_all(lifted, parameters), parameters, rules)
        kept = _are_tied(lines_m, plan, orders) and _ties(lines_m) == ties
        if kept and _in_sight(lines_m, rules):
            return lines_m
    raise InputError(
        f"cables: no way to lay {len(orders)} of them was found; got none in {PLANS} plans; "
        "try: fewer or shorter cables"
    )


def _draw(
    orders: Sequence[CableOrder],
    tied: PairName | None,
    rng: np.random.Generator,
    parameters: RodParameters,
    rules: ConfigurationRules,
) -> Plan | None:
    """Draw all cables; None when one got stuck."""
    layout = LayoutRules(shrunk(rules.area, SPRING_BACK_M), parameters.node_spacing_m)
    cores = [] if tied is None else _place_pair(tied, rng, layout, rules)
    for order in orders[len(cores) :]:
        placed = place_core(order.knot, rng, layout, rules)
        if placed is None or any(_gap_m(placed[0], core) < layout.clearance_m for core in cores):
            return None
        cores.append(placed[0])
    if len(cores) < len(orders):
        return None
    tails = replace(layout, area=shrunk(rules.tails or rules.area, SPRING_BACK_M))
    lines, spans = list(cores), [(0, len(core) - 1) for core in cores]
    for k, order in enumerate(orders):
        crossings = 0 if tied is not None and k < 2 else MOST_OF_AN_END
        grown = _grow(lines, k, order.length_m, crossings, tails, rng, rules)
        if grown is None:
            return None
        lines[k], before = grown
        spans[k] = before, before + spans[k][1]
    return Plan(tuple(lines), tuple(spans))


def _place_pair(
    tied: PairName, rng: np.random.Generator, layout: LayoutRules, rules: ConfigurationRules
) -> list[Floats]:
    """Return both cores of a knot in two cables somewhere in the area; none without room."""
    pair = PAIRS[tied]
    least_m = NODES_APART * layout.spacing_m * pair.diameter / pair.closest
    size_m = max(float(rng.uniform(*rules.diameter_m)), least_m)
    first, second = pair.curves_m(size_m, layout.spacing_m)
    mirror = np.array([1.0, rng.choice([-1.0, 1.0])])
    both = turned(np.vstack([first, second]) * mirror, float(rng.uniform(-np.pi, np.pi)))
    room_low = np.array(layout.area.low_m) - both.min(axis=0)
    room_high = np.array(layout.area.high_m) - both.max(axis=0)
    if (room_low > room_high).any():
        return []
    both = both + rng.uniform(room_low, room_high)
    return [both[: len(first)], both[len(first) :]]


def _gap_m(one: Floats, other: Floats) -> float:
    return float(np.linalg.norm(one[:, None] - other[None], axis=2).min())


def _grow(
    lines: Sequence[Floats],
    k: int,
    length_m: float,
    crossings: int,
    layout: LayoutRules,
    rng: np.random.Generator,
    rules: ConfigurationRules,
) -> tuple[Floats, int] | None:
    """Return a cable with both its ends grown, and how many nodes come before its core."""
    others = [line for other, line in enumerate(lines) if other != k]
    free_m = length_m - (len(lines[k]) - 1) * layout.spacing_m
    if free_m < 2.0 * rules.shortest_end_m:
        return None
    longest = 1.0 - rules.shortest_end_m / free_m
    share = float(np.clip(rng.uniform(*rules.place), 1.0 - longest, longest))
    curve = lines[k]
    for end_m in (free_m * share, free_m * (1.0 - share)):
        there = np.vstack([*others, curve[::-1]])
        grown = grow_end(there, end_m, int(rng.integers(crossings + 1)), layout, rng)
        if grown is None:
            return None
        curve = grown[len(there) - len(curve) :]
    return curve, round(free_m * share / layout.spacing_m)


def _raise_over(
    plan: Plan,
    orders: Sequence[CableOrder],
    tied: PairName | None,
    rng: np.random.Generator,
    parameters: RodParameters,
) -> Lines:
    """Lift upper strands over lower ones: as knots want it, and elsewhere by chance."""
    flat = [np.column_stack([p, np.full(len(p), parameters.radius_m)]) for p in plan.lines]
    starts = np.cumsum([0, *(len(line) for line in flat)]).tolist()
    spans = [(a + start, b + start) for (a, b), start in zip(plan.spans, starts, strict=False)]
    crossings = crossings_of(flat)
    drawn = {crossing: bool(rng.integers(2)) for crossing in crossings}
    for own, over in _knots(orders, tied, spans):
        inside = [c for c in crossings if _within(c.first, own) and _within(c.second, own)]
        visits = sorted(arc for c in inside for arc in (c.first, c.second))
        if len(visits) == len(over):
            mirrored = bool(rng.integers(2))
            for crossing in inside:
                drawn[crossing] = over[visits.index(crossing.first)] != mirrored
    first_over = [drawn[crossing] for crossing in crossings]
    lifted = lift_over(np.vstack(flat), crossings, first_over, LIFT_RADII * parameters.radius_m)
    return tuple(lifted[a:b] for a, b in pairwise(starts))


def _knots(
    orders: Sequence[CableOrder], tied: PairName | None, spans: Sequence[Span]
) -> list[tuple[Sequence[Span], tuple[bool, ...]]]:
    """Return where each knot is, and over and under at its visits in order."""
    knots: list[tuple[Sequence[Span], tuple[bool, ...]]] = [
        ((span,), TEMPLATES[order.knot].over)
        for order, span in zip(orders, spans, strict=True)
        if order.knot in TEMPLATES
    ]
    if tied is not None:
        knots.append((spans[:2], (*PAIRS[tied].over[0], *PAIRS[tied].over[1])))
    return knots


def _within(arc: float, spans: Sequence[Span]) -> bool:
    return any(first <= arc <= last for first, last in spans)


def _meet(plan: Plan) -> bool:
    """Return whether any two of the cables cross."""
    ends = np.cumsum([len(line) for line in plan.lines])
    crossings = crossings_of([np.column_stack([p, np.zeros(len(p))]) for p in plan.lines])
    places = [(c.first, c.second) for c in crossings]
    return any(np.ptp(np.searchsorted(ends, place, side="right")) > 0 for place in places)


def _are_tied(lines_m: Lines, plan: Plan, orders: Sequence[CableOrder]) -> bool:
    """Return whether each cable by itself has its knot, and no other one."""
    return all(
        is_tied(line_m, (span,), (order.knot,))
        for line_m, span, order in zip(lines_m, plan.spans, orders, strict=True)
    )


def _ties(lines_m: Lines) -> tuple[Tie, ...]:
    """Return what is known of each two cables."""
    return tuple(
        Tie(
            linkedness(one_m, other_m),
            tuple(polynomial_of(ring_m) for ring_m in rings_of(one_m, other_m)),
            product(polynomial_of(one_m), polynomial_of(other_m)),
        )
        for one_m, other_m in combinations(lines_m, 2)
    )


def _as_asked(ties: Sequence[Tie], tied: PairName | None) -> bool:
    """Return whether the first two cables are tied together if they should be, and no others."""
    return all(tie.apart is not (tied is not None and k == 0) for k, tie in enumerate(ties))


def _in_sight(lines_m: Lines, rules: ConfigurationRules) -> bool:
    """Return whether all cables lie in the area and no strand lies near an end."""
    area = rules.tails or rules.area
    return all(
        area.contains(line_m[:, :2])
        and ends_in_sight(line_m, others_m=[o for o in lines_m if o is not line_m])
        for line_m in lines_m
    )
