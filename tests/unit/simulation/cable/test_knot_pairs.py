"""Two cables tied together: their codes, and that no pulling apart undoes them."""

import numpy as np
import pytest

from perception.cable.topology import Diagram, Knottedness, StrandCrossing, classify_diagram
from perception.cable.topology.alexander import alexander_polynomial
from perception.cable.topology.curve import Strand, close_over, self_intersections
from perception.cable.topology.simplify import simplify
from simulation.cable.knots import PAIRS, PairTemplate

CODES = {
    "square": "O1+ U2+ O3+ O4- U5- O6- / U4- O5- U6- U1+ O2+ U3+",
    "carrick_bend": "O1- U2+ O3+ U4- O5- U6+ O2+ U7- / O4- U8+ O6+ U1- O7- U3+ O8+ U5-",
    "sheet_bend": "O1- U2- U3- O4- U5+ O6+ / U4- O7- O2- U1- U6+ O5+ U7- O3-",
}
each_pair = pytest.mark.parametrize("name", PAIRS)


@each_pair
def test_the_code_is_the_knots(name):
    assert PAIRS[name].gauss_code() == CODES[name]


@each_pair
def test_neither_cable_is_knotted_by_itself(name):
    for half in (0, 1):
        diagram = close_over(_one_of(PAIRS[name], half))
        assert classify_diagram(diagram).state is Knottedness.UNKNOT


def test_closed_cables_are_linked_as_the_knots_are():
    numbers = {name: abs(PAIRS[name].linking_number()) for name in PAIRS}
    assert numbers == {"square": 0, "carrick_bend": 1, "sheet_bend": 1}


@pytest.mark.parametrize(
    ("name", "polynomial"),
    [
        # The sum of a left and a right trefoil; the granny's has six crossings of one sign.
        ("square", (1, -2, 3, -2, 1)),
        # 8_18, the carrick mat.
        ("carrick_bend", (1, -5, 10, -13, 10, -5, 1)),
        # 6_2.
        ("sheet_bend", (1, -3, 3, -3, 1)),
    ],
)
def test_joined_to_a_ring_round_the_outside_they_are_known_knots(name, polynomial):
    diagram = _ring(PAIRS[name])
    assert diagram.is_planar()
    assert alexander_polynomial(simplify(diagram)) == polynomial


def test_the_square_knot_is_no_granny():
    diagram = _ring(PAIRS["square"])
    assert (len(diagram), sum(diagram.signs)) == (6, 0)


@each_pair
def test_sizes_are_what_they_say(name):
    pair = PAIRS[name]
    lines = pair.curves_m(1.0, 1.0 / 150.0)
    points = np.vstack(lines)
    crossings = pair.crossings()
    assert 2 * len(crossings) == sum(len(over) for over in pair.over)
    places = np.array([_at(points, c.first) for c in crossings])
    gaps = np.linalg.norm(places[:, None] - places[None], axis=2)[np.triu_indices(len(places), 1)]
    assert gaps.min() == pytest.approx(pair.closest / pair.diameter, rel=0.02)
    arcs = sorted(arc for c in crossings for arc in (c.first, c.second))
    parts = [
        points[int(min(own)) : int(max(own)) + 2]
        for own in (
            [arc for arc in arcs if arc < len(lines[0])],
            [arc for arc in arcs if arc > len(lines[0])],
        )
    ]
    assert np.ptp(np.vstack(parts), axis=0).max() == pytest.approx(1.0, rel=0.02)


def _at(points, arc):
    return [float(np.interp(arc, np.arange(len(points)), axis)) for axis in points.T]


def _one_of(pair: PairTemplate, half: int) -> Strand:
    lines = pair.curves_m(1.0, 1.0 / 150.0)
    start = half * len(lines[0])
    own = [
        StrandCrossing(c.first - start, c.second - start, c.turn, c.first_over)
        for c in pair.crossings()
        if start <= c.first < c.second < start + len(lines[half])
    ]
    return Strand(lines[half], tuple(own))


def _ring(pair: PairTemplate) -> Diagram:
    """Join both cables' lower ends, and their upper ends, round the outside."""
    first, second = pair.curves_m(1.0, 1.0 / 150.0)
    far = 3.0
    ring = np.vstack([
        first, [(-far, -far), (far, -far)], second, [(far, far), (-far, far)]
    ])  # fmt: skip
    a, b, turn = self_intersections(ring)
    over = dict(zip(np.sort([*a, *b]), (*pair.over[0], *pair.over[1]), strict=True))
    crossings = [
        StrandCrossing(float(p), float(q), int(t), over[p])
        for p, q, t in zip(a, b, turn, strict=True)
    ]
    return close_over(Strand(ring, tuple(sorted(crossings, key=lambda c: c.first))))
