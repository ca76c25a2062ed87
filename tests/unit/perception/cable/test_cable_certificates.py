"""Certificates hold when they are honest, and fail when anything in them is changed."""

from dataclasses import replace

import numpy as np
import pytest
from scrambled_diagrams import UNKNOT, scrambled

from perception.cable.topology import Diagram, Knottedness, close_over, curve_crossings
from perception.cable.topology.certificate import Certificate, certify, find_colouring
from perception.cable.topology.checker import replay
from perception.cable.topology.jones import jones_polynomial
from perception.cable.topology.moves import MoveKind, Step, slides
from perception.cable.topology.polynomial import ONE


def _diagrams(seed, corners, count):
    rng = np.random.default_rng(seed)
    return [close_over(curve_crossings(rng.normal(size=(corners, 3)))) for _ in range(count)]


def _torus_knot(p, q):
    t = np.linspace(0.0, 2.0 * np.pi, 300)
    ring = 2.0 + np.cos(q * t)
    nodes = np.c_[ring * np.cos(p * t), ring * np.sin(p * t), np.sin(q * t)][:-1]
    return close_over(curve_crossings(nodes))


def test_every_verdict_comes_with_a_proof_that_holds():
    states = set()
    for diagram in _diagrams(0, 10, 120):
        verdict, certificate = certify(diagram)
        assert certificate is not None
        checked = replay(diagram, certificate)
        assert (checked.state, checked.flaw) == (verdict.state, "")
        states.add(verdict.state)
    assert states == {Knottedness.UNKNOT, Knottedness.KNOTTED}


@pytest.mark.parametrize(("p", "q", "prime"), [(2, 3, 3), (2, 5, 5), (2, 7, 7), (3, 4, 3)])
def test_torus_knots_are_coloured_modulo_their_determinant(p, q, prime):
    # Determinants q for T(2, q), and 3 for T(3, 4) (knot tables, D. Rolfsen 1976).
    colouring = find_colouring(_torus_knot(p, q))
    assert (colouring.prime, colouring.t) == (prime, prime - 1)


def test_a_knot_of_determinant_one_is_coloured_another_way():
    # T(3, 5), the knot 10_124, has determinant 1 and no colouring with t = -1.
    diagram = _torus_knot(3, 5)
    colouring = find_colouring(diagram)
    assert colouring.t != colouring.prime - 1
    assert replay(diagram, Certificate((), colouring)).state is Knottedness.KNOTTED


def test_the_proof_of_one_knot_is_none_of_another():
    trefoil, other = _torus_knot(2, 3), _torus_knot(2, 5)
    certificate = Certificate((), find_colouring(trefoil))
    assert replay(trefoil, certificate).state is Knottedness.KNOTTED
    assert replay(other, certificate).state is Knottedness.UNDECIDED


def test_one_colour_proves_nothing():
    trefoil = _torus_knot(2, 3)
    colouring = replace(find_colouring(trefoil), colours=(1, 1, 1))
    assert "one colour" in replay(trefoil, Certificate((), colouring)).flaw


def test_nothing_proves_a_diagram_that_cannot_be_drawn():
    diagram = Diagram((0, 1, 0, 1), (True, True, False, False), (1, 1))
    assert certify(diagram)[1] is None
    assert "sphere" in replay(diagram, Certificate((), None)).flaw


def test_a_move_that_changes_what_it_should_leave_is_refused():
    refused = 0
    for diagram in _diagrams(1, 10, 80):
        _, certificate = certify(diagram)
        for number, step in enumerate(certificate.steps):
            for crossing in range(len(step.after)):
                forged = step.after.swapped(frozenset({crossing}))
                steps = (*certificate.steps[:number], Step(step.kind, step.run, forged))
                checked = replay(diagram, Certificate(steps, None))
                assert checked.flaw
                refused += checked.flaw.startswith(f"move {number}")
    assert refused > 200


def test_an_unfinished_unknotting_is_no_proof():
    for diagram in _diagrams(2, 9, 40):
        verdict, certificate = certify(diagram)
        if verdict.state is Knottedness.UNKNOT and len(certificate.steps) > 1:
            cut = replace(certificate, steps=certificate.steps[:-1])
            if cut.steps[-1].after.visits:
                assert replay(diagram, cut).flaw == "crossings are left"


def _hard_certificates(count=12):
    rng = np.random.default_rng(3)
    diagrams = [scrambled(UNKNOT, rng, 14) for _ in range(count)] + _diagrams(4, 12, 40)
    return [(diagram, certify(diagram)[1]) for diagram in diagrams]


def _one_slide(diagram):
    """A proof of nothing more than one Reidemeister III, by itself."""
    return next(iter(slides(diagram)), None)


def test_a_move_under_another_name_is_refused():
    seen = set()
    for diagram, certificate in _hard_certificates():
        for number, step in enumerate(certificate.steps):
            for kind in set(MoveKind) - {step.kind}:
                forged = replace(step, kind=kind)
                steps = (*certificate.steps[:number], forged, *certificate.steps[number + 1 :])
                checked = replay(diagram, replace(certificate, steps=steps))
                assert checked.state is Knottedness.UNDECIDED
                assert checked.flaw == f"move {number}: it is called {kind} and is {step.kind}"
                seen.add(step.kind)
    assert seen >= {MoveKind.REIDEMEISTER_1, MoveKind.REIDEMEISTER_2, MoveKind.PASS}


def test_slides_are_known_by_their_name_alone():
    seen = 0
    for diagram in _diagrams(5, 9, 60):
        step = _one_slide(diagram)
        if step is None:
            continue
        seen += 1
        assert replay(diagram, Certificate((step,))).flaw in ("", "crossings are left")
        for kind in set(MoveKind) - {step.kind}:
            assert "is called" in replay(diagram, Certificate((replace(step, kind=kind),))).flaw
        back = next(s for s in slides(step.after) if s.after.cyclic_name() == diagram.cyclic_name())
        assert "is called" not in replay(diagram, Certificate((step, back))).flaw
    assert seen > 15


def test_a_run_laid_where_it_was_is_no_slide():
    for diagram in _diagrams(6, 9, 40):
        step = _one_slide(diagram)
        if step is not None:
            start = step.run.start
            turned = Diagram(
                diagram.visits[start:] + diagram.visits[:start],
                diagram.over[start:] + diagram.over[:start],
                diagram.signs,
            )
            forged = Step(MoveKind.REIDEMEISTER_3, step.run, turned)
            assert "is pass" in replay(diagram, Certificate((forged,))).flaw


def test_a_jones_polynomial_is_added_up_anew():
    trefoil, other = _torus_knot(2, 3), _torus_knot(2, 5)
    polynomial = jones_polynomial(trefoil)
    honest = Certificate((), jones=polynomial)
    assert replay(trefoil, honest).state is Knottedness.KNOTTED
    assert "is another" in replay(other, honest).flaw
    assert "is another" in replay(trefoil.mirrored(), honest).flaw
    assert "unknot" in replay(trefoil, Certificate((), jones=ONE)).flaw
