import itertools

import numpy as np
import pytest

from perception.cable.covered_ends import ends_are_clear


def loop_over_an_end(gap_px):
    """Return a line to the right whose far end comes back down, `gap_px` beyond the near end."""
    way = np.array([[0.0, 0.0], [-200.0, 0.0], [-200.0, -150.0], [gap_px, -150.0], [gap_px, 100.0]])
    return np.concatenate([np.linspace(a, b, 80) for a, b in itertools.pairwise(way)])


@pytest.mark.parametrize(("gap_px", "clear"), [(10.0, False), (30.0, False), (60.0, True)])
@pytest.mark.parametrize("backwards", [False, True])
def test_a_strand_across_a_connector_is_seen_from_either_end(gap_px, clear, backwards):
    path = loop_over_an_end(gap_px)
    assert ends_are_clear(path[::-1] if backwards else path) is clear


def test_a_straight_cable_does_not_cover_its_own_ends():
    assert ends_are_clear(np.column_stack([np.linspace(0.0, 500.0, 200), np.zeros(200)]))
    assert ends_are_clear(np.array([[0.0, 0.0], [10.0, 0.0]]))
