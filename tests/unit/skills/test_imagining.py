"""Of pulls that can be imagined that one is best which leaves the least to do."""

import numpy as np
import pytest

from skills.cable.imagining import outcome_cost, tail_left_m
from skills.cable.laying_out import Pull

STRAIGHT_M = np.column_stack([np.linspace(-0.4, 0.4, 81), np.zeros((81, 2))])


def trefoil():
    """Return an overhand knot with its ends far out, shape (N, 3)."""
    turn = np.linspace(0.15, 2.0 * np.pi - 0.15, 300)
    across = 0.04 * np.column_stack([np.sin(turn) + 2 * np.sin(2 * turn), np.cos(turn)])
    across[:, 1] -= 0.08 * np.cos(2 * turn)
    return np.column_stack([across, -0.02 * np.sin(3 * turn)])


def test_a_knot_is_worse_than_none_and_a_long_tail_worse_than_a_short_one():
    knotted = trefoil()
    assert outcome_cost(knotted, 0.0) > outcome_cost(STRAIGHT_M, 0.0) + 3.0
    assert outcome_cost(knotted, 0.5) > outcome_cost(knotted, 0.1) > outcome_cost(knotted, 0.0)
    assert outcome_cost(STRAIGHT_M, 0.5) == outcome_cost(STRAIGHT_M, 0.0)


@pytest.mark.parametrize("drawn_m", [0.0, 0.1, 0.25])
def test_the_tail_is_what_lies_before_the_hand_that_lets_it_slide(drawn_m):
    pull = Pull(STRAIGHT_M[:, :2], 0.3, 0.5)
    ends = STRAIGHT_M[int(30 - drawn_m * 100), :2], np.array([0.5, 0.3])
    assert pull.slides(ends)
    assert tail_left_m(pull, ends, STRAIGHT_M) == pytest.approx(0.3 - drawn_m, abs=0.01)


def test_no_tail_is_left_when_the_cable_has_slipped_out_of_the_hand():
    pull = Pull(STRAIGHT_M[:, :2], 0.3, 0.5)
    assert tail_left_m(pull, (np.array([-0.45, 0.3]), np.array([0.4, 0.0])), STRAIGHT_M) == 0.0
