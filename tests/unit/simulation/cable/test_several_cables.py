"""Several cables at rest: as asked for, still, in sight, and tied together only where asked."""

from itertools import combinations

import numpy as np
import pytest

from executive.core.errors import InputError
from perception.cable.topology import Knottedness, classify_curve
from perception.cable.topology.links import Linkedness
from simulation.cable.configurations import polynomial_of
from simulation.cable.knots import PAIRS
from simulation.cable.parameters import RodParameters
from simulation.cable.rod import Rod
from simulation.cable.several import CableOrder, several_cables
from simulation.cable.truth import CableTruth, cable_truth, crossings_of, linkedness, rings_of

PLAIN = (CableOrder(), CableOrder())
RADIUS_M = RodParameters().radius_m
# The sum of two trefoils, the carrick mat 8_18, and 6_2 (D. Rolfsen's table).
RINGS = {
    "square": (1, -2, 3, -2, 1),
    "carrick_bend": (1, -5, 10, -13, 10, -5, 1),
    "sheet_bend": (1, -3, 3, -3, 1),
}


@pytest.fixture(scope="module", params=[0, 3])
def untied(request):
    orders = CableOrder("overhand"), CableOrder(length_m=1.2), CableOrder(length_m=1.0)
    return orders, several_cables(orders, np.random.default_rng(request.param))


@pytest.mark.parametrize("name", PAIRS)
@pytest.mark.parametrize("seed", [1, 2])
def test_two_cables_are_tied_by_the_knot_that_was_asked_for(name, seed):
    one_m, other_m = several_cables(PLAIN, np.random.default_rng(seed), name)
    assert all(classify_curve(line_m).state is Knottedness.UNKNOT for line_m in (one_m, other_m))
    linked = linkedness(one_m, other_m) is Linkedness.LINKED
    assert linked == (abs(PAIRS[name].linking_number()) == 1)
    assert RINGS[name] in [polynomial_of(ring_m) for ring_m in rings_of(one_m, other_m)]
    assert not cable_truth(one_m, other_m).untangled


def test_each_cable_is_as_long_as_asked_and_has_its_own_knot(untied):
    orders, lines_m = untied
    for order, line_m in zip(orders, lines_m, strict=True):
        length_m = np.linalg.norm(np.diff(line_m, axis=0), axis=1).sum()
        assert length_m == pytest.approx(order.length_m, rel=0.01)
        knotted = classify_curve(line_m).state is Knottedness.KNOTTED
        assert knotted == (order.knot != "none")


def test_cables_lie_across_each_other_without_being_tied(untied):
    _, lines_m = untied
    own = sum(len(crossings_of((line_m,))) for line_m in lines_m)
    assert len(crossings_of(lines_m)) > own
    for one_m, other_m in combinations(lines_m[1:], 2):
        assert cable_truth(one_m, other_m).untangled
    assert not cable_truth(*lines_m).untangled


def test_strands_do_not_run_through_each_other(untied):
    _, lines_m = untied
    for one_m, other_m in combinations(lines_m, 2):
        gap_m = np.linalg.norm(one_m[:, None] - other_m[None], axis=2).min()
        assert gap_m > 1.6 * RADIUS_M


def test_they_lie_still(untied):
    _, lines_m = untied
    rod = Rod(lines_m)
    rod.advance(1.0)
    assert np.abs(rod.positions_m - np.vstack(lines_m)).max() < 2e-3


def test_equal_seeds_give_bit_equal_cables():
    first, second = (several_cables(PLAIN, np.random.default_rng(7), "square") for _ in range(2))
    assert all(np.array_equal(a, b) for a, b in zip(first, second, strict=True))


def test_cables_that_have_no_room_are_told(monkeypatch):
    monkeypatch.setattr("simulation.cable.several.PLANS", 2)
    with pytest.raises(InputError, match="no way to lay 2 of them was found"):
        several_cables((CableOrder("bowline", 0.8),) * 2, np.random.default_rng(0))


def test_a_bight_that_another_cable_goes_through_ties_them():
    bight = np.array([[-0.3, 0.05], [0.0, 0.05], [0.1, 0.0], [0.0, -0.05], [-0.3, -0.05]])
    through = np.array([[0.02, -0.3], [0.02, -0.06], [0.02, 0.06], [0.02, 0.3]])
    flat = np.column_stack([bight, np.full(5, 0.01)])
    over, woven = np.full(4, 0.02), np.array([0.02, 0.02, 0.0, 0.0])
    assert cable_truth(flat, np.column_stack([through, over])) == CableTruth(True, 2)
    assert cable_truth(flat, np.column_stack([through, woven])) == CableTruth(False, 2)
