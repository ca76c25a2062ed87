"""Names of knots: polynomials of the table, mirror images, sums, and other people's packages."""

import itertools

import numpy as np
import pytest
from scrambled_diagrams import UNKNOT, scrambled

from perception.cable.topology import Knottedness, Proof, classify_diagram, knot_type
from perception.cable.topology.alexander import alexander_polynomial
from perception.cable.topology.braids import BRAIDS, closed_braid
from perception.cable.topology.certificate import certify
from perception.cable.topology.checker import replay
from perception.cable.topology.diagram import Diagram
from perception.cable.topology.jones import jones_polynomial
from perception.cable.topology.names import _invariants, _names, summands
from perception.cable.topology.polynomial import ONE, Laurent

# 11n_34 and 11n_42: the smallest knots whose Alexander polynomial is 1.
CONWAY = (-1, 2, -1, 2, -1, 3, -2, -2, -1, 3, 3)
KINOSHITA_TERASAKA = (-1, 2, 2, -3, -3, 2, 1, -2, -2, 3, -2, 3, -2)


def joined(*parts: Diagram) -> Diagram:
    """The sum of knots: one curve through all of them."""
    visits, over, signs = list[int](), list[bool](), list[int]()
    for part in parts:
        visits += [crossing + len(signs) for crossing in part.visits]
        over += part.over
        signs += part.signs
    return Diagram(tuple(visits), tuple(over), tuple(signs))


@pytest.mark.parametrize("name", BRAIDS)
def test_each_braid_is_named_after_its_knot_also_in_the_mirror(name):
    diagram = closed_braid(BRAIDS[name])
    assert diagram.is_planar()
    seen, mirrored = knot_type(diagram), knot_type(diagram.mirrored())
    assert seen.split()[0] == mirrored.split()[0] == name
    hands = {"left", "right"}
    assert {seen, mirrored} in ({name}, {f"{name} {hand}" for hand in hands})


def test_amphicheiral_knots_have_no_hand():
    # C. Livingston and A. Moore, KnotInfo: of 8_17 the mirror image runs backwards.
    without = {n for n, b in BRAIDS.items() if knot_type(closed_braid(b)) == n}
    assert without == {"4_1", "6_3", "8_3", "8_9", "8_12", "8_17", "8_18"}


def test_published_polynomials_are_met():
    # D. Rolfsen 1976 (Alexander), V. Jones 1987 (right-handed trefoil: t + t^3 - t^4).
    alexander = {
        "3_1": (1, -1, 1),
        "5_2": (2, -3, 2),
        "6_1": (2, -5, 2),
        "7_4": (4, -7, 4),
        "8_18": (1, -5, 10, -13, 10, -5, 1),
    }
    for name, polynomial in alexander.items():
        assert alexander_polynomial(closed_braid(BRAIDS[name])) == polynomial
    assert jones_polynomial(closed_braid((1, 1, 1))) == Laurent(1, (1, 0, 1, -1))
    assert jones_polynomial(closed_braid((1, -2, 1, -2))) == Laurent(-2, (1, -1, 1, -1, 1))


def test_no_two_names_share_their_polynomials():
    names = list(_names().values())
    # 35 primes, 28 of them with two hands; 14 sums up to 8 crossings; the unknot.
    assert len(names) == len(set(names)) == 35 + 28 + 14 + 1


def test_values_of_the_jones_polynomial_that_every_knot_has():
    # V(1) = 1; V at minus one is the determinant up to its sign (V. Jones 1985).
    for braid in BRAIDS.values():
        diagram = closed_braid(braid)
        polynomial = jones_polynomial(diagram)
        assert sum(polynomial.coefficients) == 1
        at_minus_one = sum(c * (-1) ** k for k, c in enumerate(polynomial.coefficients))
        alexander = alexander_polynomial(diagram)
        assert abs(at_minus_one) == abs(sum(c * (-1) ** k for k, c in enumerate(alexander)))


def test_sums_are_named_by_their_parts():
    right, eight = closed_braid((1, 1, 1)), closed_braid((1, -2, 1, -2))
    granny, square = joined(right, right), joined(right, right.mirrored())
    assert knot_type(granny) == "3_1 right # 3_1 right"
    assert knot_type(square) == "3_1 left # 3_1 right"
    assert knot_type(joined(right, eight, eight)) == "3_1 right # 4_1 # 4_1"
    assert len(list(summands(joined(right, eight, eight)))) == 3


def test_polynomials_of_a_sum_are_products():
    for one, other in itertools.combinations(("3_1", "4_1", "5_2"), 2):
        a, b = closed_braid(BRAIDS[one]), closed_braid(BRAIDS[other])
        for of_sum, of_a, of_b in zip(
            _invariants(joined(a, b)), _invariants(a), _invariants(b), strict=True
        ):
            assert of_sum == of_a * of_b


def test_sums_that_are_hidden_are_named_by_their_polynomials():
    # 8_9 and 4_1 # 4_1 have one Jones polynomial; the Alexander polynomial parts them.
    assert _names()[_invariants(closed_braid(BRAIDS["8_9"]))] == "8_9"
    eight = closed_braid(BRAIDS["4_1"])
    assert _names()[_invariants(joined(eight, eight))] == "4_1 # 4_1"


@pytest.mark.parametrize("name", ["3_1", "4_1", "5_2", "6_2"])
def test_scrambling_keeps_the_name(name):
    rng, diagram = np.random.default_rng(30), closed_braid(BRAIDS[name])
    for _ in range(5):
        assert knot_type(scrambled(diagram, rng, 14)) == knot_type(diagram)


def test_unknots_larger_knots_and_nonsense_have_names_of_their_own():
    assert knot_type(UNKNOT) == "0_1"
    assert knot_type(scrambled(UNKNOT, np.random.default_rng(31), 12)) == "0_1"
    assert knot_type(closed_braid((1,) * 9)) == "other"
    # 10_132 has both polynomials of 5_1 (V. Jones 1987).
    lookalike = closed_braid((1, 1, 1, -2, -1, -1, -2, -3, 2, -3, -3))
    assert _invariants(lookalike) in [
        _invariants(d) for d in (closed_braid((1,) * 5), closed_braid((-1,) * 5))
    ]
    assert knot_type(lookalike) == "other"
    assert knot_type(Diagram((0, 1, 0, 1), (True, True, False, False), (1, 1))) == "unknown"


@pytest.mark.parametrize("braid", [CONWAY, KINOSHITA_TERASAKA])
def test_what_alexander_cannot_tell_is_proved_by_jones(braid):
    diagram = closed_braid(braid)
    assert alexander_polynomial(diagram) == (1,)
    assert jones_polynomial(diagram) != ONE
    verdict = classify_diagram(diagram)
    assert (verdict.state, verdict.proof) == (Knottedness.KNOTTED, Proof.JONES)
    _, certificate = certify(diagram)
    assert replay(diagram, certificate).state is Knottedness.KNOTTED
    assert knot_type(diagram) == "other"


def test_names_agree_with_snappy():
    snappy = pytest.importorskip("snappy")
    for name, braid in BRAIDS.items():
        # Torus knots are not hyperbolic, so that SnapPy cannot know them by their volume.
        if name in ("3_1", "5_1", "7_1", "8_19"):
            continue
        exterior = snappy.Link(braid_closure=list(braid)).exterior()
        assert any(str(known).startswith(f"{name}(") for known in exterior.identify())
