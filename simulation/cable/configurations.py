"""Starting configurations: a cable with one knot, a fake one or none, at rest on the table."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from executive.core.errors import InputError
from perception.cable.topology import Knottedness, classify_curve, close_over, curve_crossings
from perception.cable.topology.alexander import alexander_polynomial
from perception.cable.topology.simplify import simplify
from simulation.cable.heights import lift_over
from simulation.cable.knots import KNOT_NAMES, TEMPLATES, KnotName, KnotTemplate, fake_overs
from simulation.cable.layout import Area, LayoutRules, grow_end
from simulation.cable.parameters import RodParameters
from simulation.cable.rod import Rod
from simulation.cable.truth import centre_line_crossings

Floats = NDArray[np.float64]


# What both arms can reach with their grippers pointing down.
REACHABLE = Area((-0.40, -0.20), (0.40, 0.17))


@dataclass(frozen=True, slots=True)
class ConfigurationRules:
    """What starting configurations have in common.

    Attributes:
        length_m: Length of the cable.
        diameter_m: Smallest and largest size of the knot; one that has no room for its crossings
            is laid somewhat larger.
        place: Between which fractions of the cable's length the knot lies.
        area: Where the arms reach, and all of the cable lies.
        most_crossings: Most crossings of the whole cable; where the knot alone takes up as many,
            there may be one more than it has.
        shortest_end_m: Least length of a free end.
        still_m: No node moves farther once the cable is let go again. Tight knots, whose strands
            press upon each other, are let go several times until this holds.
    """

    length_m: float = 3.0
    diameter_m: tuple[float, float] = (0.10, 0.20)
    place: tuple[float, float] = (0.25, 0.75)
    area: Area = REACHABLE
    most_crossings: int = 6
    shortest_end_m: float = 0.25
    still_m: float = 1.5e-3


# Springing back, a cable moves by about this much until it rests.
SPRING_BACK_M = 0.012
# An upper strand starts this many radii higher than the lower one: just clear of it.
LIFT_RADII = 2.2
# Crossings of a knot are at least so many nodes apart: over and under take turns in between.
NODES_APART = 2.2
# How often a cable that has settled is let go again at most, and for how long.
SETTLINGS, LET_GO_S = 8, 1.0
# How many plans are drawn before giving up: most get stuck, and cost a few hundredths of a second.
PLANS = 500


def starting_configuration(
    knot: KnotName,
    rng: np.random.Generator,
    parameters: RodParameters | None = None,
    rules: ConfigurationRules | None = None,
    fake: bool = False,
) -> Floats:
    """Return a cable at rest with the named knot, both its ends free and in sight.

    Args:
        knot: Which knot; `none` gives a cable that may cross itself but is not knotted.
        rng: Source of all randomness: an equal state gives an equal configuration.
        parameters: What the cable is made of.
        rules: Where and how it lies.
        fake: Whether it shall but look like that knot, and be none.

    Returns:
        Node positions [m], world frame, shape (N, 3).

    Raises:
        InputError: The knot is not known, or no configuration was found within the rules.
    """
    if knot not in KNOT_NAMES:
        known = ", ".join(KNOT_NAMES)
        raise InputError(f"cable.knot: unknown knot; got {knot!r}; expected one of: {known}")
    parameters, rules = parameters or RodParameters(), rules or ConfigurationRules()
    for _ in range(PLANS):
        plan = draw_plan(knot, rng, parameters, rules, fake)
        if plan is not None and is_tied(plan, knot, fake):
            nodes_m = _at_rest(settle(plan, parameters), parameters, rules)
            if is_tied(nodes_m, knot, fake) and _follows(nodes_m, knot, rules):
                return nodes_m
    raise InputError(
        f"cable.knot: no configuration with {knot!r} within the rules; got none in {PLANS} "
        "plans; try: a shorter cable, a larger area, or more crossings"
    )


def draw_plan(
    knot: KnotName,
    rng: np.random.Generator,
    parameters: RodParameters,
    rules: ConfigurationRules,
    fake: bool = False,
) -> Floats | None:
    """Draw a centre line with true over and under, not yet at rest; None when it got stuck."""
    layout = LayoutRules(_shrunk(rules.area, SPRING_BACK_M), parameters.node_spacing_m)
    core = _place_core(knot, rng, layout, rules)
    if core is None:
        return None
    template = TEMPLATES.get(knot)
    spare = _most_crossings(knot, rules) - (template.crossings if template else 0)
    free_m = rules.length_m - (len(core) - 1) * layout.spacing_m
    longest = 1.0 - rules.shortest_end_m / free_m
    share = float(np.clip(rng.uniform(*rules.place), 1.0 - longest, longest))
    first = int(rng.integers(spare + 1))
    curve = grow_end(core, free_m * share, first, layout, rng)
    if curve is not None:
        curve = grow_end(curve[::-1], free_m * (1.0 - share), spare - first, layout, rng)
    if curve is None:
        return None
    curve = curve[::-1]
    start = len(curve) - round(free_m * share / layout.spacing_m) - len(core)
    fakes = fake_overs(template) if template and fake else ()
    over = fakes[int(rng.integers(len(fakes)))] if fakes else ()
    return _raise_over(curve, (start, start + len(core) - 1), template, over, rng, parameters)


def settle(nodes_m: Floats, parameters: RodParameters, longest_s: float = 6.0) -> Floats:
    """Let a cable come to rest on the table and return where it lies, shape (N, 3)."""
    rod = Rod(nodes_m, parameters)
    while rod.time_s < longest_s:
        rod.advance(0.25)
        if rod.at_rest:
            break
    return rod.positions_m.copy()


def _at_rest(nodes_m: Floats, parameters: RodParameters, rules: ConfigurationRules) -> Floats:
    """Return where a cable lies that has settled, and stays once it is let go again."""
    for _ in range(SETTLINGS):
        if not np.isfinite(rules.still_m):
            break
        rod = Rod(nodes_m, parameters)
        rod.advance(LET_GO_S)
        if float(np.abs(rod.positions_m - nodes_m).max()) < rules.still_m:
            break
        nodes_m = rod.positions_m.copy()
    return nodes_m


def _shrunk(area: Area, margin_m: float) -> Area:
    return Area(
        (area.low_m[0] + margin_m, area.low_m[1] + margin_m),
        (area.high_m[0] - margin_m, area.high_m[1] - margin_m),
    )


def _place_core(
    knot: KnotName, rng: np.random.Generator, layout: LayoutRules, rules: ConfigurationRules
) -> Floats | None:
    """Return the knot, or a straight piece, somewhere in the area, shape (N, 2)."""
    if knot in TEMPLATES:
        template = TEMPLATES[knot]
        least_m = NODES_APART * layout.spacing_m * template.diameter / template.closest
        diameter_m = max(float(rng.uniform(*rules.diameter_m)), least_m)
        curve = template.curve_m(diameter_m, layout.spacing_m)
    else:
        curve = np.column_stack([np.arange(8) * layout.spacing_m, np.zeros(8)])
    angle = rng.uniform(-np.pi, np.pi)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    mirror = np.array([1.0, rng.choice([-1.0, 1.0])])
    curve = (curve * mirror) @ turn.T
    low, high = np.array(layout.area.low_m), np.array(layout.area.high_m)
    room_low, room_high = low - curve.min(axis=0), high - curve.max(axis=0)
    if (room_low > room_high).any():
        return None
    placed: Floats = curve + rng.uniform(room_low, room_high)
    return placed


def _raise_over(
    curve: Floats,
    knot: tuple[int, int],
    template: KnotTemplate | None,
    over: tuple[bool, ...],
    rng: np.random.Generator,
    parameters: RodParameters,
) -> Floats:
    """Lift the upper strand of every crossing over the lower one, shape (N, 3).

    Crossings between the nodes `knot` follow the template, or `over` where given, or the mirror
    image; who is on top at the others is drawn.
    """
    flat = np.column_stack([curve, np.full(len(curve), parameters.radius_m)])
    crossings = centre_line_crossings(flat)
    inside = [c for c in crossings if knot[0] <= c.first and c.second <= knot[1]]
    mirrored = bool(rng.integers(2))
    drawn = {crossing: bool(rng.integers(2)) for crossing in crossings}
    if template is not None:
        for crossing, on_top in zip(inside, template.first_over(inside, over), strict=True):
            drawn[crossing] = on_top != mirrored
    first_over = [drawn[crossing] for crossing in crossings]
    return lift_over(flat, crossings, first_over, LIFT_RADII * parameters.radius_m)


def is_tied(nodes_m: Floats, knot: KnotName, fake: bool = False) -> bool:
    """Return whether exactly the wanted knot is tied, none for a fake one or for `none`.

    The knots are told apart by their Alexander polynomials, which all differ.
    """
    if fake or knot not in TEMPLATES:
        return classify_curve(nodes_m).state is Knottedness.UNKNOT
    closed = close_over(curve_crossings(nodes_m))
    return alexander_polynomial(simplify(closed)) == _polynomial(TEMPLATES[knot])


@cache
def _polynomial(template: KnotTemplate) -> tuple[int, ...]:
    return alexander_polynomial(template.diagram())


def _most_crossings(knot: KnotName, rules: ConfigurationRules) -> int:
    own = TEMPLATES[knot].crossings if knot in TEMPLATES else 0
    return rules.most_crossings if own < rules.most_crossings else own + 1


def _follows(nodes_m: Floats, knot: KnotName, rules: ConfigurationRules) -> bool:
    """Return whether a cable at rest keeps the rules: area, crossings, ends in sight."""
    return (
        rules.area.contains(nodes_m[:, :2])
        and len(centre_line_crossings(nodes_m)) <= _most_crossings(knot, rules)
        and ends_in_sight(nodes_m)
    )


def ends_in_sight(nodes_m: Floats, clearance_m: float = 0.02, within_m: float = 0.04) -> bool:
    """Return whether no other strand lies near the last stretch at either end."""
    arcs_m = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(nodes_m, axis=0), axis=1))])
    for arcs, points in ((arcs_m, nodes_m), (arcs_m[-1] - arcs_m, nodes_m)):
        tip, rest = points[arcs <= within_m, :2], points[arcs > within_m + 2.0 * clearance_m, :2]
        if np.linalg.norm(tip[:, None] - rest[None], axis=2).min() < clearance_m:
            return False
    return True
