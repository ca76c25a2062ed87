"""Cables of the thesis's tiers: the right knots and crossings, at rest, out of view if asked."""

import numpy as np
import pytest

from executive.core.errors import InputError
from perception.cable.topology import classify_curve
from simulation.cable.configurations import is_tied, starting_configuration
from simulation.cable.rod import Rod
from simulation.cable.rules import ConfigurationRules
from simulation.cable.tiers import TIERS, VIEW, tier_cable
from simulation.cable.truth import centre_line_crossings

# Crossings that are left of both knots of C3 when nothing else is.
SUMS = {
    frozenset(("overhand", "figure_8_honda")): 9,
    frozenset(("figure_8", "figure_8_honda")): 10,
    frozenset(("figure_8", "linked_overhand")): 12,
}


@pytest.fixture(scope="module", params=[(tier, out) for tier in TIERS for out in (False, True)])
def laid(request):
    tier, leaves_view = request.param
    return tier, tier_cable(tier, np.random.default_rng(1), leaves_view=leaves_view)


def test_each_knot_comes_from_its_group_and_crossings_are_within_the_tier(laid):
    tier, cable = laid
    low, high = TIERS[tier].crossings
    groups = TIERS[tier].classes
    assert sorted(next(k for k, g in enumerate(groups) if name in g) for name in cable.knots) == [
        *range(len(groups))
    ]
    assert low <= len(centre_line_crossings(cable.nodes_m)) <= high


def test_no_more_is_tied_than_the_knots_of_the_tier(laid):
    _, cable = laid
    reduced = classify_curve(cable.nodes_m).reduced_crossings
    if len(cable.knots) == 1:
        assert is_tied(cable.nodes_m, ((0, len(cable.nodes_m) - 1),), cable.knots)
    else:
        assert reduced == SUMS[frozenset(cable.knots)]


def test_one_end_is_out_of_view_where_asked_and_else_none(laid):
    _, cable = laid
    seen = VIEW.holds(cable.nodes_m[:, :2])
    places = np.flatnonzero(seen)
    assert seen[places[0] : places[-1] + 1].all()
    assert (seen[0], seen[-1]) != (False, False)
    assert bool(seen.all()) is not cable.leaves_view


def test_it_lies_still(laid):
    _, cable = laid
    rod = Rod(cable.nodes_m)
    rod.advance(0.5)
    # What hangs over an edge swings a little.
    seen = VIEW.holds(cable.nodes_m[:, :2])
    np.testing.assert_allclose(rod.positions_m[seen], cable.nodes_m[seen], atol=3e-3)


def test_equal_seeds_give_bit_equal_cables():
    one, other = (tier_cable("C1", np.random.default_rng(2)) for _ in range(2))
    assert one.nodes_m.tobytes() == other.nodes_m.tobytes()
    assert (one.knots, one.leaves_view) == (other.knots, other.leaves_view)


def test_what_cannot_be_laid_is_said():
    rules = ConfigurationRules(length_m=0.9)
    with pytest.raises(InputError, match="no configuration with 'bowline' and 'bowline' within"):
        starting_configuration(
            ("bowline", "bowline"), np.random.default_rng(0), rules=rules, plans=3
        )
