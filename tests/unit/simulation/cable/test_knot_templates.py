"""The knots are the ones they are named after: their codes, and what they close to."""

import numpy as np
import pytest

from perception.cable.topology import (
    Knottedness,
    Strand,
    classify_curve,
    classify_diagram,
    close_over,
)
from perception.cable.topology.alexander import alexander_polynomial
from perception.cable.topology.certificate import certify
from perception.cable.topology.checker import replay
from perception.cable.topology.curve import self_intersections
from perception.cable.topology.simplify import simplify
from simulation.cable.knots import KNOT_NAMES, TEMPLATES, fake_overs, gauss_code

# Followed by hand along the drawings.
CODES = {
    "overhand": "O1+ U2+ O3+ U1+ O2+ U3+",
    "figure_8": "O1- U2- O3+ U4+ O2- U1- O4+ U3+",
    "overhand_honda": "O1+ U2+ O3+ U4+ O5+ U1+ O2+ U5+ O4+ U3+",
    "bowline": "O1- U2+ U3- O4- O5+ U6+ O2+ U7- U8+ U5+ O6+ U1- O7- O3- U4- O8+",
    "linked_overhand": "O1- U2- O3- U4- O5- U1- O2- U5- O6- U7- O8- U6- O4- U3- O7- U8-",
    "figure_8_honda": "O1- U2- O3+ U4+ O5+ U6+ O2- U1- O6+ U5+ O4+ U3+",
}
# Least crossings and Alexander polynomial, as in D. Rolfsen's table.
TABLE = {
    "3_1": (3, (1, -1, 1)),
    "4_1": (4, (1, -3, 1)),
    "5_2": (5, (2, -3, 2)),
    "6_1": (6, (2, -5, 2)),
    "6_3": (6, (1, -3, 5, -3, 1)),
    "8_15": (8, (3, -8, 11, -8, 3)),
}
TYPES = {
    "overhand": "3_1",
    "figure_8": "4_1",
    "overhand_honda": "5_2",
    "bowline": "6_3",
    "linked_overhand": "8_15",
    "figure_8_honda": "6_1",
}
each_knot = pytest.mark.parametrize("knot", TEMPLATES)


def test_every_name_but_none_has_a_template():
    assert set(TEMPLATES) == set(KNOT_NAMES) - {"none"} == set(CODES)


@each_knot
def test_the_code_is_the_knots(knot):
    assert gauss_code(TEMPLATES[knot].strand().crossings) == CODES[knot]


@each_knot
def test_it_closes_to_the_knot_of_the_table(knot):
    template = TEMPLATES[knot]
    diagram = template.diagram()
    assert diagram.is_planar()
    assert classify_diagram(diagram).state is Knottedness.KNOTTED
    reduced = simplify(diagram)
    assert template.closes_to == TYPES[knot]
    assert (len(reduced), alexander_polynomial(reduced)) == TABLE[template.closes_to]


def test_an_independent_package_finds_the_same_knots():
    spherogram = pytest.importorskip("spherogram")
    for template in TEMPLATES.values():
        strand = template.strand()
        link = spherogram.Link(_pd_code(strand))
        link.simplify("global")
        crossings, polynomial = TABLE[template.closes_to]
        assert len(link.crossings) == crossings
        hfk = link.knot_floer_homology()
        assert 2 * hfk["seifert_genus"] == len(polynomial) - 1


def _pd_code(strand: Strand) -> list[tuple[int, int, int, int]]:
    """Write a closed diagram as spherogram takes it: edges round each crossing."""
    diagram = close_over(strand)
    count = len(diagram.visits)
    place = {
        (crossing, on_top): k
        for k, (crossing, on_top) in enumerate(zip(diagram.visits, diagram.over, strict=True))
    }
    code = []
    for crossing, sign in enumerate(diagram.signs):
        under, over = place[crossing, False], place[crossing, True]
        under_out, over_out = (under + 1) % count, (over + 1) % count
        beside = (over, over_out) if sign > 0 else (over_out, over)
        code.append((under, beside[0], under_out, beside[1]))
    return code


@each_knot
def test_loop_knots_lose_what_their_end_holds_when_it_is_pulled_out(knot):
    template = TEMPLATES[knot]
    # Visits from the first of these on are the end that passes through.
    passes, left = {
        "overhand_honda": (8, "3_1"),
        "figure_8_honda": (10, "4_1"),
        "bowline": (9, None),
    }.get(knot, (len(template.over), template.closes_to))
    strand = template.strand()
    arcs = sorted(arc for c in strand.crossings for arc in (c.first, c.second))
    end = arcs[passes] if passes < len(arcs) else np.inf
    kept = Strand(
        strand.points[: int(min(end, len(strand.points)))],
        tuple(c for c in strand.crossings if c.second < end),
    )
    reduced = simplify(close_over(kept))
    expected = TABLE[left] if left else (0, (1,))
    assert (len(reduced), alexander_polynomial(reduced)) == expected


@each_knot
@pytest.mark.parametrize("size_m", [0.06, 0.15, 0.40])
def test_at_any_size_it_crosses_alike_and_keeps_to_gentle_bends(knot, size_m):
    template = TEMPLATES[knot]
    curve_m = template.curve_m(size_m, size_m / 100.0)
    first, _, _ = self_intersections(curve_m)
    assert len(first) == template.crossings
    steps_m = np.linalg.norm(np.diff(curve_m, axis=0), axis=1)
    turns = np.diff(np.unwrap(np.arctan2(*np.diff(curve_m, axis=0).T[::-1])))
    assert steps_m == pytest.approx(size_m / 100.0, rel=0.03)
    assert (np.abs(turns) * 0.04 * size_m < steps_m[1:]).all()


@each_knot
def test_sizes_are_what_they_say(knot):
    template = TEMPLATES[knot]
    strand = template.strand()
    arcs = [arc for c in strand.crossings for arc in (c.first, c.second)]
    closed = strand.points[int(min(arcs)) : int(max(arcs)) + 2]
    assert np.ptp(closed, axis=0).max() == pytest.approx(1.0, rel=0.02)
    places = np.array([_at(strand.points, c.first) for c in strand.crossings])
    gaps = np.linalg.norm(places[:, None] - places[None], axis=2)[np.triu_indices(len(places), 1)]
    assert gaps.min() == pytest.approx(template.closest / template.diameter, rel=0.02)
    # With room for a cable of a width, crossings are farther apart than the cable is wide.
    assert gaps.min() * template.least_diameter_m(0.0066) > 1.5 * 0.0066


def _at(points, arc):
    return [float(np.interp(arc, np.arange(len(points)), axis)) for axis in points.T]


@each_knot
def test_fakes_are_proved_to_be_no_knots_by_moves_that_can_be_replayed(knot):
    template = TEMPLATES[knot]
    fakes = fake_overs(template)
    assert len(set(fakes)) == len(fakes) >= 4
    for over in fakes:
        diagram = template.diagram(over)
        verdict, certificate = certify(diagram)
        assert verdict.state is Knottedness.UNKNOT
        assert replay(diagram, certificate).state is Knottedness.UNKNOT


@each_knot
def test_fakes_have_the_knots_curve_and_are_not_just_laid_down_in_order(knot):
    template = TEMPLATES[knot]
    true = template.strand()
    for over in fake_overs(template):
        fake = template.strand(over)
        assert fake.points.tobytes() == true.points.tobytes()
        assert len({crossing.first_over for crossing in fake.crossings}) == 2
        assert gauss_code(fake.crossings) != CODES[knot]


@each_knot
def test_a_cable_in_space_along_a_template_is_that_knot(knot):
    strand = TEMPLATES[knot].strand()
    heights = np.zeros(len(strand.points))
    for crossing in strand.crossings:
        heights[round(crossing.first if crossing.first_over else crossing.second)] = 1.0
        heights[round(crossing.second if crossing.first_over else crossing.first)] = -1.0
    verdict = classify_curve(np.column_stack([strand.points, heights]))
    assert verdict.state is Knottedness.KNOTTED
    assert verdict.reduced_crossings == TABLE[TYPES[knot]][0]
