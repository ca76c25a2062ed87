"""Starting configurations: a cable with knots, fake ones or none, at rest on the table."""

from collections.abc import Sequence
from functools import cache, reduce

import numpy as np
from numpy.typing import NDArray

from executive.core.errors import InputError
from perception.cable.topology import Knottedness, classify_curve, close_over, curve_crossings
from perception.cable.topology.alexander import alexander_polynomial
from perception.cable.topology.simplify import simplify
from simulation.cable.knots import KNOT_NAMES, TEMPLATES, KnotName
from simulation.cable.parameters import RodParameters
from simulation.cable.plans import Spans, draw_plan, leaves_as_asked, most_crossings
from simulation.cable.rod import Rod
from simulation.cable.rules import ConfigurationRules
from simulation.cable.truth import centre_line_crossings

Floats = NDArray[np.float64]
Polynomial = tuple[int, ...]
Lines = tuple[Floats, ...]

# How often a cable that has settled is let go again at most, and for how long.
SETTLINGS, LET_GO_S = 8, 1.0
# So long a cable is waited for.
LONGEST_S = 6.0
# How many plans are drawn before giving up: most get stuck, and cost a few hundredths of a second.
PLANS = 500
# Nodes beside a knot that belong to it once it has settled.
BESIDE = 4


def starting_configuration(
    knots: KnotName | Sequence[KnotName],
    rng: np.random.Generator,
    parameters: RodParameters | None = None,
    rules: ConfigurationRules | None = None,
    fake: bool = False,
    plans: int = PLANS,
) -> Floats:
    """Return a cable at rest with the named knot, both its ends free and in sight.

    Args:
        knots: Which knot, or knots in the order of the cable; `none` gives a cable that may
            cross itself but is not knotted.
        rng: Source of all randomness: an equal state gives an equal configuration.
        parameters: What the cable is made of.
        rules: Where and how it lies.
        fake: Whether it shall but look like that knot, and be none.
        plans: How many are drawn before giving up.

    Returns:
        Node positions [m], world frame, shape (N, 3).

    Raises:
        InputError: A knot is not known, or no configuration was found within the rules.
    """
    names = _checked((knots,) if isinstance(knots, str) else tuple(knots))
    parameters, rules = parameters or RodParameters(), rules or ConfigurationRules()
    for _ in range(plans):
        plan = draw_plan(names, rng, parameters, rules, fake)
        if plan is not None and is_tied(*plan, names, fake):
            dropped_m = plan[0] + (0.0, 0.0, rules.drop_m)
            (nodes_m,) = rest((settle(dropped_m, parameters),), parameters, rules)
            if is_tied(nodes_m, plan[1], names, fake) and _follows(nodes_m, names, rules):
                return nodes_m
    raise InputError(
        f"cable.knot: no configuration with {' and '.join(map(repr, names))} within the rules; got "
        f"none in {plans} plans; try: a shorter cable, a larger area, or more crossings"
    )


def _checked(names: tuple[KnotName, ...]) -> tuple[KnotName, ...]:
    for name in names:
        if name not in KNOT_NAMES:
            known = ", ".join(KNOT_NAMES)
            raise InputError(f"cable.knot: unknown knot; got {name!r}; expected one of: {known}")
    return names


def settle(nodes_m: Floats, parameters: RodParameters, longest_s: float = LONGEST_S) -> Floats:
    """Let a cable come to rest on the table and return where it lies, shape (N, 3)."""
    return settle_all((nodes_m,), parameters, longest_s)[0]


def settle_all(
    lines_m: Sequence[Floats], parameters: RodParameters, longest_s: float = LONGEST_S
) -> Lines:
    """Let cables come to rest together and return where each lies, shape (N_k, 3)."""
    rod = Rod(lines_m, parameters)
    while rod.time_s < longest_s:
        rod.advance(0.25)
        if rod.at_rest:
            break
    return _copied(rod)


def rest(lines_m: Lines, parameters: RodParameters, rules: ConfigurationRules) -> Lines:
    """Return where cables lie that have settled, and stay once they are let go again."""
    for _ in range(SETTLINGS):
        if not np.isfinite(rules.still_m):
            break
        rod = Rod(lines_m, parameters)
        rod.advance(LET_GO_S)
        if float(np.abs(rod.positions_m - np.vstack(lines_m)).max()) < rules.still_m:
            break
        lines_m = _copied(rod)
    return lines_m


def _copied(rod: Rod) -> Lines:
    return tuple(line_m.copy() for line_m in rod.lines_m)


def is_tied(nodes_m: Floats, spans: Spans, knots: Sequence[KnotName], fake: bool = False) -> bool:
    """Return whether exactly the wanted knots are tied, none for fake ones or for `none`.

    Knots are told apart by their Alexander polynomials, which all differ; that of several in
    series is the product. Of several each must be tied where it was laid.

    Args:
        nodes_m: The cable, shape (N, 3).
        spans: First and last node of each knot.
        knots: Which they should be.
        fake: Whether they should but look like it.
    """
    if fake or not any(knot in TEMPLATES for knot in knots):
        return classify_curve(nodes_m).state is Knottedness.UNKNOT
    wanted = [_polynomial(knot) for knot in knots]
    if polynomial_of(nodes_m) != reduce(product, wanted):
        return False
    parts = (nodes_m[max(0, first - BESIDE) : last + 1 + BESIDE] for first, last in spans)
    return len(knots) == 1 or all(
        polynomial_of(part) == own for part, own in zip(parts, wanted, strict=True)
    )


def polynomial_of(nodes_m: Floats) -> Polynomial:
    """Return the Alexander polynomial of a cable whose ends are joined over everything."""
    return alexander_polynomial(simplify(close_over(curve_crossings(nodes_m))))


@cache
def _polynomial(knot: KnotName) -> Polynomial:
    return alexander_polynomial(TEMPLATES[knot].diagram()) if knot in TEMPLATES else (1,)


def product(one: Polynomial, other: Polynomial) -> Polynomial:
    """Return the product of two polynomials up to a sign, the first coefficient positive."""
    product = np.convolve(one, other)
    return tuple(int(coefficient) for coefficient in product * np.sign(product[0]))


def _follows(nodes_m: Floats, knots: Sequence[KnotName], rules: ConfigurationRules) -> bool:
    """Return whether a cable at rest keeps the rules: area, crossings, ends in sight."""
    crossings = len(centre_line_crossings(nodes_m))
    in_area = rules.view is not None or (rules.tails or rules.area).contains(nodes_m[:, :2])
    return (
        in_area
        and leaves_as_asked(nodes_m, rules)
        and rules.least_crossings <= crossings <= most_crossings(knots, rules)
        and ends_in_sight(nodes_m[rules.view.holds(nodes_m[:, :2])] if rules.view else nodes_m)
    )


def ends_in_sight(
    nodes_m: Floats,
    clearance_m: float = 0.02,
    within_m: float = 0.04,
    others_m: Sequence[Floats] = (),
) -> bool:
    """Return whether no other strand, of it or of others, lies near the last stretch at an end."""
    arcs_m = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(nodes_m, axis=0), axis=1))])
    for arcs, points in ((arcs_m, nodes_m), (arcs_m[-1] - arcs_m, nodes_m)):
        tip, rest = points[arcs <= within_m, :2], points[arcs > within_m + 2.0 * clearance_m, :2]
        around = np.vstack([rest, *(other[:, :2] for other in others_m)])
        if np.linalg.norm(tip[:, None] - around[None], axis=2).min() < clearance_m:
            return False
    return True
