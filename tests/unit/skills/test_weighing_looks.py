import pytest
from hypothesis import given
from hypothesis import strategies as st

from skills.cable.weigh_look import SUREST, expected, weighed

beliefs = st.floats(0.0, 1.0)
inner = st.floats(0.01, 0.99)


@given(beliefs)
def test_a_look_that_tells_nothing_leaves_the_belief_as_it_was(before):
    assert weighed(before, 0.5) == pytest.approx(before)


@given(inner, beliefs)
def test_two_looks_tell_more_than_one_the_same_way(before, seen):
    once = weighed(before, seen)
    assert (weighed(once, seen) - once) * (seen - 0.5) >= 0.0


@given(inner, inner, inner)
def test_the_order_of_looks_does_not_matter(before, one, other):
    ways = [weighed(weighed(before, a), b) for a, b in ((one, other), (other, one))]
    assert ways[0] == pytest.approx(ways[1])


@given(beliefs)
def test_a_pull_undoes_more_than_another_move(before):
    assert expected(before, pulled=True) <= expected(before, pulled=False)


def test_one_look_ends_the_mission_after_a_pull_and_not_right_after_a_sure_knot():
    sure_knot = weighed(0.5, 1.0)
    assert weighed(expected(sure_knot, pulled=True), 0.0) < 0.05
    first = weighed(expected(sure_knot, pulled=False), 0.0)
    assert first > 0.05
    assert weighed(expected(first, pulled=False), 0.0) < 0.05


def test_no_look_is_surer_than_it_can_be():
    assert weighed(0.5, 0.0) == pytest.approx(1.0 - SUREST)
    assert weighed(0.5, 1.0) == pytest.approx(SUREST)
