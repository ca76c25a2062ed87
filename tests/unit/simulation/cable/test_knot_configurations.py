"""Starting configurations: the right knot, at rest, in reach, the same for the same seed."""

import numpy as np
import pytest

from executive.core.errors import InputError
from perception.cable.topology import Knottedness, classify_curve
from simulation.cable.configurations import (
    REACHABLE,
    ConfigurationRules,
    draw_plan,
    ends_in_sight,
    settle,
    starting_configuration,
)
from simulation.cable.knots import KNOT_NAMES, TEMPLATES
from simulation.cable.parameters import RodParameters
from simulation.cable.rod import Rod
from simulation.cable.truth import cable_truth, centre_line_crossings


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
        assert verdict.reduced_crossings == {"overhand": 3, "figure_8": 4}[knot]
        assert not cable_truth(nodes_m).untangled


def test_the_cable_lies_whole_in_reach_with_its_ends_in_sight(laid):
    _, nodes_m = laid
    assert nodes_m.shape == (301, 3)
    assert REACHABLE.contains(nodes_m[:, :2])
    assert nodes_m[:, 2].max() < 0.03
    assert len(centre_line_crossings(nodes_m)) <= 6
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
        plan = draw_plan("overhand", rng, parameters, rules)
        if plan is None:
            continue
        seen += 1
        before, after = classify_curve(plan), classify_curve(settle(plan, parameters))
        assert (before.state, before.reduced_crossings) == (after.state, after.reduced_crossings)


@pytest.mark.parametrize("knot", TEMPLATES)
def test_templates_cross_as_often_as_they_say(knot):
    curve = TEMPLATES[knot].curve_m(0.15, 0.005)
    crossings = centre_line_crossings(np.column_stack([curve, np.zeros(len(curve))]))
    assert 2 * len(crossings) == len(TEMPLATES[knot].over)


def test_an_unknown_knot_is_answered_with_the_known_ones():
    with pytest.raises(InputError, match="got 'granny'; expected one of: none, overhand"):
        starting_configuration("granny", np.random.default_rng(0))
