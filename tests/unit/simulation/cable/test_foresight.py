"""Imagined pulls: the knot that was believed in is the one that is moved, by the cable physics."""

import numpy as np
import pytest

from perception.cable.interfaces import Foresight
from perception.cable.topology import Knottedness, classify_curve, curve_crossings
from perception.cable.types import ImaginedHand
from simulation.cable.configurations import starting_configuration
from simulation.cable.foresight import ORDINARY, CableForesight, raised
from simulation.cable.rod import Rod


def laid(knot, seed=3):
    """Return a cable at rest as it is seen from above, and where it lies on top of itself."""
    nodes_m = starting_configuration(knot, np.random.default_rng(seed))
    crossings = curve_crossings(nodes_m).crossings
    over = [c.first if c.first_over else c.second for c in crossings]
    return nodes_m[:, :2], [place / (len(nodes_m) - 1) for place in over]


def test_it_is_a_foresight():
    assert isinstance(CableForesight(), Foresight)


def test_a_line_rises_only_where_it_lies_on_top():
    line_m = np.column_stack([np.linspace(0.0, 1.0, 50), np.zeros(50)])
    heights_m = raised(line_m, [0.25], ORDINARY)[:, 2]
    assert heights_m[[0, -1]] == pytest.approx(ORDINARY.radius_m, abs=1e-6)
    assert np.argmax(heights_m) == pytest.approx(0.25 * (len(heights_m) - 1), abs=1)
    assert heights_m.max() > 2.0 * ORDINARY.radius_m
    assert raised(line_m, [], ORDINARY)[:, 2] == pytest.approx(ORDINARY.radius_m)


@pytest.mark.parametrize("knot", ["none", "overhand", "figure_8"])
def test_what_is_imagined_has_the_knot_that_was_seen(knot):
    line_m, over = laid(knot)
    nodes_m = raised(line_m, over, ORDINARY)
    rod = Rod((nodes_m,), ORDINARY)
    rod.advance(0.5)
    assert classify_curve(rod.positions_m).reduced_crossings == (
        classify_curve(nodes_m).reduced_crossings
    )
    expected = Knottedness.UNKNOT if knot == "none" else Knottedness.KNOTTED
    assert classify_curve(rod.positions_m).state is expected


def test_a_hand_takes_the_cable_along_and_leaves_the_knot():
    line_m, over = laid("overhand")
    to_m = line_m[0] + np.array([0.03, 0.03])
    nodes_m = CableForesight().after(line_m, over, [ImaginedHand("pinch", 0.01, to_m)])
    assert nodes_m is not None
    assert np.linalg.norm(nodes_m[:5, :2] - to_m, axis=1).min() < 0.015
    assert classify_curve(nodes_m).state is Knottedness.KNOTTED


def test_the_same_pull_is_imagined_the_same():
    line_m, over = laid("overhand")
    hands = [ImaginedHand("cage", 0.2, line_m[0]), ImaginedHand("pinch", 0.6, line_m[-1])]
    one, other = (CableForesight().after(line_m, over, hands) for _ in range(2))
    assert one is not None
    assert np.array_equal(one, other)


def test_a_hand_that_lets_go_leaves_the_end_that_would_have_been_torn_out():
    line_m = np.column_stack([np.linspace(-0.4, 0.4, 60), np.zeros(60)])
    to_m = np.array([0.45, 0.1])
    for lets_go in (0.2, 1.0):
        hands = [
            ImaginedHand("cage", 0.2, np.array([-0.44, 0.1]), lets_go),
            ImaginedHand("pinch", 0.5, to_m),
        ]
        nodes_m = CableForesight().after(line_m, [], hands)
        assert nodes_m is not None
        # The pinch has the cable where it took it only if nothing held the plug back.
        slipped_m = np.linalg.norm(nodes_m[len(nodes_m) // 2, :2] - to_m)
        assert bool(slipped_m < 0.02) is (lets_go < 1.0)
