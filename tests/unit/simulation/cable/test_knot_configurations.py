"""Starting configurations: the right knot, at rest, in reach, the same for the same seed."""

import numpy as np
import pytest

from executive.core.errors import InputError
from perception.cable.topology import Knottedness, classify_curve
from simulation.cable.configurations import ends_in_sight, settle, starting_configuration
from simulation.cable.knots import KNOT_NAMES, TEMPLATES
from simulation.cable.parameters import RodParameters
from simulation.cable.plans import draw_plan
from simulation.cable.rod import Rod
from simulation.cable.rules import REACHABLE, ConfigurationRules
from simulation.cable.truth import cable_truth, centre_line_crossings

LEAST_CROSSINGS = {
    "overhand": 3,
    "figure_8": 4,
    "overhand_honda": 5,
    "bowline": 6,
    "linked_overhand": 8,
    "figure_8_honda": 6,
}


@pytest.fixture(scope="module", params=KNOT_NAMES)
def laid(request):
    return request.param, starting_configuration(request.param, np.random.default_rng(3))


def test_the_wanted_knot_is_tied_and_no_other(laid):
    knot, nodes_m = laid
    verdict = classify_curve(nodes_m)
    if knot == "none":
        assert verdict.state is Knottedness.UNKNOT
        assert cable_truth(nodes_m).untangled
    else:
        assert verdict.state is Knottedness.KNOTTED
        assert verdict.reduced_crossings == LEAST_CROSSINGS[knot]
        assert not cable_truth(nodes_m).untangled


def test_the_cable_lies_whole_in_reach_with_its_ends_in_sight(laid):
    knot, nodes_m = laid
    assert nodes_m.shape == (301, 3)
    assert REACHABLE.contains(nodes_m[:, :2])
    assert nodes_m[:, 2].max() < 0.03
    assert len(centre_line_crossings(nodes_m)) <= {"bowline": 9, "linked_overhand": 9}.get(knot, 7)
    assert ends_in_sight(nodes_m)
    assert np.linalg.norm(np.diff(nodes_m, axis=0), axis=1).sum() == pytest.approx(3.0, rel=0.02)


def test_the_cable_is_at_rest(laid):
    rod = Rod(laid[1])
    rod.advance(1.0)
    np.testing.assert_allclose(rod.positions_m, laid[1], atol=2e-3)


def test_equal_seeds_give_bit_equal_configurations():
    first, second = (starting_configuration("overhand", np.random.default_rng(1)) for _ in range(2))
    assert first.tobytes() == second.tobytes()


def test_settling_keeps_the_knot_of_every_plan():
    rng, parameters, rules = np.random.default_rng(5), RodParameters(), ConfigurationRules()
    seen = 0
    while seen < 2:
        plan = draw_plan(("overhand",), rng, parameters, rules)
        if plan is None:
            continue
        seen += 1
        before, after = classify_curve(plan[0]), classify_curve(settle(plan[0], parameters))
        assert (before.state, before.reduced_crossings) == (after.state, after.reduced_crossings)


@pytest.mark.parametrize("knot", TEMPLATES)
def test_a_fake_knot_lies_like_it_and_is_none(knot):
    nodes_m = starting_configuration(knot, np.random.default_rng(4), fake=True)
    assert classify_curve(nodes_m).state is Knottedness.UNKNOT
    # Where nothing holds them, a strand or two spring aside.
    assert len(centre_line_crossings(nodes_m)) >= 0.5 * TEMPLATES[knot].crossings
    assert ends_in_sight(nodes_m)


def test_an_unknown_knot_is_answered_with_the_known_ones():
    with pytest.raises(InputError, match="got 'granny'; expected one of: none, overhand"):
        starting_configuration("granny", np.random.default_rng(0))
