"""Laws of the named moves: the knot stays, the plane stays, each has its inverse."""

import numpy as np
import pytest
from scrambled_diagrams import UNKNOT, scrambled, with_bigon, with_loop

from perception.cable.topology import Knottedness, classify_diagram, close_over, curve_crossings
from perception.cable.topology.alexander import alexander_polynomial
from perception.cable.topology.certificate import certify
from perception.cable.topology.checker import replay
from perception.cable.topology.jones import jones_polynomial
from perception.cable.topology.moves import MoveKind, first_bigon, first_loop, slides
from perception.cable.topology.simplify import simplification


@pytest.fixture(scope="module")
def diagrams():
    rng = np.random.default_rng(20)
    return [close_over(curve_crossings(rng.normal(size=(9, 3)))) for _ in range(60)]


def same_knot(before, after):
    return (
        after.is_planar()
        and alexander_polynomial(after) == alexander_polynomial(before)
        and jones_polynomial(after) == jones_polynomial(before)
    )


def test_the_first_move_takes_one_crossing_out_and_keeps_the_knot(diagrams):
    steps = [(d, step) for d in diagrams if (step := first_loop(d))]
    assert len(steps) > 20
    for diagram, step in steps:
        assert step.kind is MoveKind.REIDEMEISTER_1
        assert len(step.after) == len(diagram) - 1
        assert same_knot(diagram, step.after)


def test_the_second_move_takes_two_crossings_out_and_keeps_the_knot(diagrams):
    steps = [(d, step) for d in diagrams if (step := first_bigon(d))]
    assert len(steps) > 20
    for diagram, step in steps:
        assert step.kind is MoveKind.REIDEMEISTER_2
        assert len(step.after) == len(diagram) - 2
        assert same_knot(diagram, step.after)


def test_the_third_move_keeps_crossings_and_knot_and_is_undone_by_another(diagrams):
    seen = 0
    for diagram in diagrams:
        for step in slides(diagram):
            seen += 1
            assert step.kind is MoveKind.REIDEMEISTER_3
            assert sorted(step.after.signs) == sorted(diagram.signs)
            assert same_knot(diagram, step.after)
            back = {slid.after.cyclic_name() for slid in slides(step.after)}
            assert diagram.cyclic_name() in back
    assert seen > 50


def test_loops_that_are_put_in_are_taken_out(diagrams):
    for diagram in diagrams[:12]:
        for edge in range(len(diagram.visits)):
            for sign, over_first in ((1, True), (1, False), (-1, True), (-1, False)):
                looped = with_loop(diagram, edge, sign, over_first)
                assert same_knot(diagram, looped)
                rests = {first_loop(looped).after.cyclic_name()}
                if first_loop(diagram) is None:
                    assert rests == {diagram.cyclic_name()}


def test_strands_that_are_laid_over_others_are_pulled_off(diagrams):
    seen = 0
    for diagram in diagrams[:30]:
        if first_bigon(diagram) is not None or len(diagram) < 3:
            continue
        for upper in range(len(diagram.visits)):
            for lower in range(len(diagram.visits)):
                for laid in with_bigon(diagram, upper, lower) if upper != lower else ():
                    seen += 1
                    assert same_knot(diagram, laid)
                    assert first_bigon(laid) is not None
    assert seen > 50


def test_names_do_not_depend_on_where_the_curve_starts(diagrams):
    for diagram in diagrams[:20]:
        for k in range(len(diagram.visits)):
            turned = type(diagram)(
                diagram.visits[k:] + diagram.visits[:k],
                diagram.over[k:] + diagram.over[:k],
                diagram.signs,
            )
            assert turned.cyclic_name() == diagram.cyclic_name()


def test_scrambled_unknots_are_undone_with_proofs_that_hold():
    rng, kinds = np.random.default_rng(21), set()
    for _ in range(40):
        diagram = scrambled(UNKNOT, rng, 16)
        verdict, certificate = certify(diagram)
        assert verdict.state is Knottedness.UNKNOT
        assert replay(diagram, certificate).state is Knottedness.UNKNOT
        kinds |= {step.kind for step in certificate.steps}
    assert kinds >= {MoveKind.REIDEMEISTER_1, MoveKind.REIDEMEISTER_2}


def test_scrambled_trefoils_stay_knotted(trefoil):
    rng = np.random.default_rng(22)
    for _ in range(20):
        assert classify_diagram(scrambled(trefoil, rng, 14)).reduced_crossings == 3


@pytest.fixture
def trefoil():
    t = np.linspace(0.0, 2.0 * np.pi, 240)
    ring = 2.0 + np.cos(3.0 * t)
    nodes = np.c_[ring * np.cos(2.0 * t), ring * np.sin(2.0 * t), np.sin(3.0 * t)][:-1]
    return close_over(curve_crossings(nodes))


def test_moves_lead_from_one_diagram_to_the_next_without_more_crossings():
    rng = np.random.default_rng(23)
    for _ in range(20):
        diagram = scrambled(UNKNOT, rng, 14)
        sizes = [len(diagram), *(len(step.after) for step in simplification(diagram))]
        assert sizes == sorted(sizes, reverse=True)
        assert sizes[-1] == 0
