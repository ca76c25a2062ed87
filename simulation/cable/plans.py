"""Centre lines with knots, drawn at random: what cables are laid after before they settle."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from simulation.cable.heights import lift_over
from simulation.cable.knots import TEMPLATES, KnotName, KnotTemplate, fake_overs
from simulation.cable.layout import Area, LayoutRules, fits_on, grow_end
from simulation.cable.parameters import RodParameters
from simulation.cable.rules import ConfigurationRules
from simulation.cable.truth import centre_line_crossings

Floats = NDArray[np.float64]
# First and last node of each knot.
Spans = tuple[tuple[int, int], ...]

# Springing back, a cable moves by about this much until it rests.
SPRING_BACK_M = 0.012
# An upper strand starts this many radii higher than the lower one: just clear of it.
LIFT_RADII = 2.2
# Crossings of a knot are at least so many nodes apart: over and under take turns in between.
NODES_APART = 2.2
# An end that leaves the view is drawn on for so much beyond its border.
BEYOND_M = 0.2


def draw_plan(
    knots: Sequence[KnotName],
    rng: np.random.Generator,
    parameters: RodParameters,
    rules: ConfigurationRules,
    fake: bool = False,
) -> tuple[Floats, Spans] | None:
    """Draw a centre line with true over and under, not yet at rest; None when it got stuck.

    Args:
        knots: Which knots, in the order of the cable.
        rng: Source of all randomness.
        parameters: What the cable is made of.
        rules: Where and how it lies.
        fake: Whether each knot shall but look like one.

    Returns:
        Node positions [m], shape (N, 3), and where in them each knot is.
    """
    layout = LayoutRules(shrunk(rules.area, SPRING_BACK_M), parameters.node_spacing_m)
    core = place_core(knots[0], rng, layout, rules)
    for knot in knots[1:]:
        core = None if core is None else _tie_another(core, knot, rng, layout, rules)
    if core is None:
        return None
    line, spans = core
    spare = most_crossings(knots, rules) - own_crossings(knots)
    ends = _grow_ends(line, spare, rng, layout, rules)
    if ends is None:
        return None
    curve, before = ends
    placed = tuple((first + before, last + before) for first, last in spans)
    return _raise_over(curve, placed, knots, fake, rng, parameters), placed


def own_crossings(knots: Sequence[KnotName]) -> int:
    """Return how many crossings the knots have by themselves."""
    return sum(TEMPLATES[knot].crossings for knot in knots if knot in TEMPLATES)


def most_crossings(knots: Sequence[KnotName], rules: ConfigurationRules) -> int:
    """Return how many crossings a cable with these knots may have."""
    own = own_crossings(knots)
    return rules.most_crossings if own < rules.most_crossings else own + 1


def _grow_ends(
    core: Floats,
    spare: int,
    rng: np.random.Generator,
    layout: LayoutRules,
    rules: ConfigurationRules,
) -> tuple[Floats, int] | None:
    """Return the whole line and how many nodes come before the core; None when it got stuck."""
    free_m = rules.length_m - (len(core) - 1) * layout.spacing_m
    longest = 1.0 - rules.shortest_end_m / free_m
    share = float(np.clip(rng.uniform(*rules.place), 1.0 - longest, longest))
    first = int(rng.integers(spare + 1))
    areas = _areas_of_ends(rng, rules)
    curve = grow_end(core, free_m * share, first, _within(layout, areas[0]), rng)
    if curve is not None:
        rest_m = free_m * (1.0 - share)
        curve = grow_end(curve[::-1], rest_m, spare - first, _within(layout, areas[1]), rng)
    if curve is None or not leaves_as_asked(curve, rules):
        return None
    return curve[::-1], len(curve) - round(free_m * share / layout.spacing_m) - len(core)


def _areas_of_ends(rng: np.random.Generator, rules: ConfigurationRules) -> tuple[Area, Area]:
    """Return where either end may lie: as a rule the same area, for one that leaves a larger."""
    area = shrunk(rules.tails or rules.area, SPRING_BACK_M)
    if rules.view is None:
        return area, area
    low, high = rules.view.low_m, rules.view.high_m
    beyond = (
        Area((low[0] - BEYOND_M, area.low_m[1]), area.high_m),
        Area(area.low_m, (high[0] + BEYOND_M, area.high_m[1])),
        Area((area.low_m[0], low[1] - BEYOND_M), area.high_m),
    )
    larger = beyond[int(rng.integers(len(beyond)))]
    return (larger, area) if rng.integers(2) else (area, larger)


def leaves_as_asked(points_m: Floats, rules: ConfigurationRules) -> bool:
    """Return whether as much of one end lies out of the view as the rules want, and no more."""
    if rules.view is None:
        return True
    inside = rules.view.holds(points_m[:, :2])
    places = np.flatnonzero(inside)
    if not len(places) or not inside[places[0] : places[-1] + 1].all():
        return False
    spacing_m = rules.length_m / (len(points_m) - 1)
    out_m = sorted(spacing_m * np.array([places[0], len(inside) - 1 - places[-1]]))
    return bool(out_m[0] == 0.0 and rules.out_m[0] <= out_m[1] <= rules.out_m[1])


def _within(layout: LayoutRules, area: Area) -> LayoutRules:
    return LayoutRules(area, layout.spacing_m)


def shrunk(area: Area, margin_m: float) -> Area:
    """Return an area less a margin on all sides."""
    return Area(
        (area.low_m[0] + margin_m, area.low_m[1] + margin_m),
        (area.high_m[0] - margin_m, area.high_m[1] - margin_m),
    )


def _core(
    knot: KnotName, rng: np.random.Generator, layout: LayoutRules, rules: ConfigurationRules
) -> Floats:
    """Return the knot, or a straight piece, anywhere and any way round, shape (N, 2)."""
    if knot in TEMPLATES:
        template = TEMPLATES[knot]
        least_m = NODES_APART * layout.spacing_m * template.diameter / template.closest
        diameter_m = max(float(rng.uniform(*rules.diameter_m)), least_m)
        return template.curve_m(diameter_m, layout.spacing_m)
    return np.column_stack([np.arange(8) * layout.spacing_m, np.zeros(8)])


def place_core(
    knot: KnotName, rng: np.random.Generator, layout: LayoutRules, rules: ConfigurationRules
) -> tuple[Floats, Spans] | None:
    """Return the knot, or a straight piece, somewhere in the area, shape (N, 2)."""
    curve = _core(knot, rng, layout, rules)
    angle = rng.uniform(-np.pi, np.pi)
    mirror = np.array([1.0, rng.choice([-1.0, 1.0])])
    curve = turned(curve * mirror, angle)
    low, high = np.array(layout.area.low_m), np.array(layout.area.high_m)
    room_low, room_high = low - curve.min(axis=0), high - curve.max(axis=0)
    if (room_low > room_high).any():
        return None
    return curve + rng.uniform(room_low, room_high), ((0, len(curve) - 1),)


def _tie_another(
    core: tuple[Floats, Spans],
    knot: KnotName,
    rng: np.random.Generator,
    layout: LayoutRules,
    rules: ConfigurationRules,
) -> tuple[Floats, Spans] | None:
    """Lead a line on from its last knot to another one; None where that has no room."""
    line, spans = core
    grown = grow_end(line, float(rng.uniform(*rules.between_m)), 0, layout, rng)
    if grown is None:
        return None
    curve = _core(knot, rng, layout, rules) * np.array([1.0, rng.choice([-1.0, 1.0])])
    ways = np.arctan2(*np.array([grown[-1] - grown[-2], curve[1] - curve[0]]).T[::-1])
    curve = turned(curve, float(ways[0] - ways[1]))
    curve = curve[1:] + (grown[-1] - curve[0])
    if not (layout.area.contains(curve) and fits_on(curve, grown, layout)):
        return None
    longer = np.vstack([grown, curve])
    return longer, (*spans, (len(grown), len(longer) - 1))


def turned(points: Floats, angle_rad: float) -> Floats:
    """Return points of the plane turned about the origin, shape (N, 2)."""
    turn = np.array(
        [[np.cos(angle_rad), -np.sin(angle_rad)], [np.sin(angle_rad), np.cos(angle_rad)]]
    )
    turned: Floats = points @ turn.T
    return turned


def _raise_over(
    curve: Floats,
    spans: Spans,
    knots: Sequence[KnotName],
    fake: bool,
    rng: np.random.Generator,
    parameters: RodParameters,
) -> Floats:
    """Lift the upper strand of every crossing over the lower one, shape (N, 3).

    Crossings within a knot's span follow its template or the mirror image, or look but like it
    where it is a fake; who is on top at the others is drawn.
    """
    templates = [TEMPLATES.get(knot) for knot in knots]
    overs = [_fake_over(template, rng) if fake else () for template in templates]
    flat = np.column_stack([curve, np.full(len(curve), parameters.radius_m)])
    crossings = centre_line_crossings(flat)
    mirrored = [bool(rng.integers(2)) for _ in knots]
    drawn = {crossing: bool(rng.integers(2)) for crossing in crossings}
    for span, template, over, turned in zip(spans, templates, overs, mirrored, strict=True):
        inside = [c for c in crossings if span[0] <= c.first and c.second <= span[1]]
        if template is not None:
            for crossing, on_top in zip(inside, template.first_over(inside, over), strict=True):
                drawn[crossing] = on_top != turned
    first_over = [drawn[crossing] for crossing in crossings]
    return lift_over(flat, crossings, first_over, LIFT_RADII * parameters.radius_m)


def _fake_over(template: KnotTemplate | None, rng: np.random.Generator) -> tuple[bool, ...]:
    fakes = fake_overs(template) if template else ()
    return fakes[int(rng.integers(len(fakes)))] if fakes else ()
