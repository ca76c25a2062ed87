"""Laws of knots: invariants stay, proofs agree, mirrors mirror."""

from dataclasses import replace

import numpy as np
import pytest

from perception.cable.topology import (
    Diagram,
    Knottedness,
    Proof,
    classify_curve,
    classify_diagram,
    close_over,
    curve_crossings,
)
from perception.cable.topology.alexander import alexander_polynomial, determinant
from perception.cable.topology.passes import reroutes, runs
from perception.cable.topology.rule import Visit, cancel, knot_intervals
from perception.cable.topology.simplify import shorten, simplify


def torus_knot(p: int, q: int, count: int = 240) -> np.ndarray:
    """A closed curve, cut at one node whose ends almost meet."""
    t = np.linspace(0.0, 2.0 * np.pi, count)
    ring = 2.0 + np.cos(q * t)
    return np.c_[ring * np.cos(p * t), ring * np.sin(p * t), np.sin(q * t)][:-1]


def figure_8_knot(count: int = 300) -> np.ndarray:
    t = np.linspace(0.0, 2.0 * np.pi, count)
    ring = 2.0 + np.cos(2.0 * t)
    return np.c_[ring * np.cos(3.0 * t), ring * np.sin(3.0 * t), np.sin(4.0 * t)][:-1]


def turned(nodes: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """The closed curve seen from another side; the gap of the cut is closed first."""
    closed = np.vstack([nodes, nodes[0] + 1e-6 * (nodes[-1] - nodes[0])])
    rotation, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    rotation[:, 0] *= np.linalg.det(rotation)
    return closed @ rotation


def random_diagram(rng: np.random.Generator, corners: int) -> Diagram:
    return close_over(curve_crossings(rng.normal(size=(corners, 3))))


KNOTS = {
    "trefoil": (torus_knot(2, 3), (1, -1, 1)),
    "figure 8": (figure_8_knot(), (1, -3, 1)),
    "5_1": (torus_knot(2, 5), (1, -1, 1, -1, 1)),
    "8_19": (torus_knot(3, 4, 400), (1, -1, 0, 1, 0, -1, 1)),
}


def test_crossings_too_near_to_each_other_to_be_told_in_order_still_give_the_knot():
    rng = np.random.default_rng(4)
    told = 0
    for _ in range(60):
        strand = curve_crossings(rng.normal(size=(8, 3)))
        places = sorted(at for c in strand.crossings for at in (c.first, c.second))
        gaps = np.diff(places)
        if not len(gaps) or gaps.min() > 0.1:
            continue
        near = places[int(gaps.argmin())]
        beyond = near + float(gaps.min()) + 0.02
        moved = [
            replace(
                c,
                first=beyond if c.first == near else c.first,
                second=beyond if c.second == near else c.second,
            )
            for c in strand.crossings
        ]
        other = replace(strand, crossings=tuple(moved))
        if any(c.first >= c.second for c in moved):
            continue
        assert close_over(other).is_planar()
        told += 1
        assert (
            classify_diagram(close_over(other)).state is classify_diagram(close_over(strand)).state
        )
    assert told > 10


@pytest.mark.parametrize("name", KNOTS)
def test_known_knots_have_their_alexander_polynomial_from_every_side(name):
    nodes, polynomial = KNOTS[name]
    rng = np.random.default_rng(1)
    for view in (nodes, *(turned(nodes, rng) for _ in range(6))):
        diagram = close_over(curve_crossings(view))
        assert diagram.is_planar()
        assert alexander_polynomial(diagram) == polynomial
        assert alexander_polynomial(simplify(diagram)) == polynomial
        assert determinant(diagram) == abs(sum(c * (-1) ** k for k, c in enumerate(polynomial)))
        verdict = classify_curve(view)
        assert (verdict.state, verdict.proof) == (Knottedness.KNOTTED, Proof.ALEXANDER)


def test_simplifying_finds_the_fewest_crossings_of_small_knots():
    rng = np.random.default_rng(2)
    for name, fewest in (("trefoil", 3), ("figure 8", 4), ("5_1", 5)):
        view = turned(KNOTS[name][0], rng)
        assert classify_curve(view).reduced_crossings == fewest


def test_a_curve_that_only_climbs_is_an_unknot():
    rng = np.random.default_rng(3)
    most = 0
    for _ in range(60):
        nodes = rng.normal(size=(14, 3))
        nodes[:, 2] = np.arange(14.0)
        verdict = classify_curve(nodes)
        most = max(most, verdict.crossings)
        assert (verdict.state, verdict.proof) == (Knottedness.UNKNOT, Proof.MOVES)
    assert most > 15


def test_a_closed_climbing_curve_stays_an_unknot_from_every_side():
    rng = np.random.default_rng(4)
    for _ in range(30):
        nodes = rng.normal(size=(12, 3))
        nodes[:, 2] = np.arange(12.0)
        assert classify_curve(turned(nodes, rng)).state is Knottedness.UNKNOT


def test_moves_keep_the_polynomial_and_the_plane():
    rng = np.random.default_rng(5)
    for _ in range(60):
        diagram = random_diagram(rng, 9)
        polynomial = alexander_polynomial(diagram)
        for run in runs(diagram):
            for moved in reroutes(diagram, run, limit=3):
                assert moved.is_planar()
                assert len(moved) <= len(diagram)
                assert alexander_polynomial(moved) == polynomial


def test_search_behind_equal_moves_never_loses_against_shortening():
    rng = np.random.default_rng(6)
    for _ in range(60):
        diagram = random_diagram(rng, 12)
        assert len(simplify(diagram)) <= len(shorten(diagram))


def test_mirrors_are_knotted_alike():
    rng = np.random.default_rng(7)
    for _ in range(40):
        diagram = random_diagram(rng, 10)
        mirrored = diagram.mirrored()
        assert mirrored.mirrored() == diagram
        assert alexander_polynomial(mirrored) == alexander_polynomial(diagram)
        assert classify_diagram(mirrored).state is classify_diagram(diagram).state


def test_the_verdict_does_not_depend_on_how_the_curve_is_walked():
    rng = np.random.default_rng(8)
    for _ in range(40):
        nodes = rng.normal(size=(10, 3))
        state = classify_curve(nodes).state
        assert classify_curve(nodes[::-1]).state is state
        assert classify_curve(nodes * [-1.0, 1.0, 1.0]).state is state


def test_straight_and_short_curves_have_no_crossings():
    long, short = np.zeros((50, 3)), np.zeros((2, 3))
    long[:, 0], short[:, 0] = np.arange(50.0), np.arange(2.0)
    for nodes in (long, short):
        verdict = classify_curve(nodes)
        assert (verdict.state, verdict.crossings) == (Knottedness.UNKNOT, 0)


def test_a_diagram_that_cannot_be_drawn_stays_undecided():
    # One crossing of each of two curves that interleave: the code of a virtual knot.
    diagram = Diagram((0, 1, 0, 1), (True, True, False, False), (1, 1))
    assert not diagram.is_planar()
    assert classify_diagram(diagram).state is Knottedness.UNDECIDED


def visits(*named: tuple[int, str]) -> list[Visit]:
    return [Visit(number, way == "o", float(k)) for k, (number, way) in enumerate(named)]


def test_rule_cancels_loops_and_pairs():
    assert cancel(visits((0, "o"), (0, "u"))) == []
    assert cancel(visits((0, "o"), (1, "o"), (1, "u"), (0, "u"))) == []
    clasp = visits((0, "o"), (1, "u"), (0, "u"), (1, "o"))
    assert cancel(clasp) == clasp


def test_rule_names_the_overhand_knot():
    trefoil = visits((0, "u"), (1, "o"), (2, "u"), (0, "o"), (1, "u"), (2, "o"))
    ((first, last),) = knot_intervals(trefoil)
    assert (first.crossing, first.over, last.arc) == (0, False, 3.0)


def test_rule_sees_no_knot_without_an_overcrossing_inside():
    assert knot_intervals(visits((0, "u"), (1, "u"), (0, "o"), (1, "o"))) == []
