"""Of pulls that can be imagined that one is best which leaves the least to do."""

import numpy as np
import pytest

from skills.cable.imagining import KNOT_COST, best_imagined, outcome_cost, shorter_tail_m
from skills.cable.laying_out import Pull

STRAIGHT_M = np.column_stack([np.linspace(-0.4, 0.4, 81), np.zeros((81, 2))])


def trefoil():
    """Return an overhand knot with its ends far out, shape (N, 3)."""
    turn = np.linspace(0.15, 2.0 * np.pi - 0.15, 300)
    across = 0.04 * np.column_stack([np.sin(turn) + 2 * np.sin(2 * turn), np.cos(turn)])
    across[:, 1] -= 0.08 * np.cos(2 * turn)
    return np.column_stack([across, -0.02 * np.sin(3 * turn)])


def with_tails(first_m, last_m):
    """Return an overhand knot with straight tails of 1 cm steps, shape (N, 3)."""
    knot = trefoil()
    ways = knot[0] - knot[1], knot[-1] - knot[-2]
    first, last = (
        0.01 * np.arange(1, round(length_m / 0.01) + 1)[:, None] * way / np.linalg.norm(way)
        for length_m, way in zip((first_m, last_m), ways, strict=True)
    )
    return np.vstack([(knot[0] + first)[::-1], knot, knot[-1] + last])


def test_a_knot_is_worse_than_none_and_a_long_tail_worse_than_a_short_one():
    costs = [outcome_cost(with_tails(first_m, 0.4)) for first_m in (0.05, 0.15, 0.3)]
    assert costs == sorted(costs)
    assert costs[0] > outcome_cost(STRAIGHT_M) + KNOT_COST
    assert outcome_cost(STRAIGHT_M) == 0.0


@pytest.mark.parametrize("turned", [False, True])
def test_the_tail_to_draw_grows_with_the_shorter_tail_alone(turned):
    short, longer, other = (
        shorter_tail_m(with_tails(*(tails[::-1] if turned else tails)))
        for tails in ((0.1, 0.4), (0.2, 0.4), (0.1, 0.5))
    )
    assert longer - short == pytest.approx(0.1, abs=0.03)
    assert other == pytest.approx(short, abs=0.03)
    assert shorter_tail_m(STRAIGHT_M) is None


class Lucky:
    """Imagines a straight cable for a pull that takes hold just so, and a knot a little off it."""

    def __init__(self, exact):
        self.exact = exact

    def after(self, line_m, over, hands):
        if hands[1].to_m[0] == 0.3:
            return STRAIGHT_M if hands[0].arc == pytest.approx(self.exact) else with_tails(0.8, 0.8)
        return with_tails(0.05, 0.4)


def test_a_pull_that_is_good_by_luck_alone_is_not_the_best():
    pull = Pull(STRAIGHT_M[:, :2], 0.2, 0.4)
    lucky, steady = ((np.array([-0.3, 0.0]), np.array([x_m, 0.0])) for x_m in (0.3, 0.35))
    found = best_imagined(Lucky(0.2 / 0.8), [(pull, [lucky, steady])], [])
    assert [one.ends is steady for one in found] == [True, False]
    assert found[0].cost == pytest.approx(outcome_cost(with_tails(0.05, 0.4)))
