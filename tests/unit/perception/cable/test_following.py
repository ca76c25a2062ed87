import numpy as np
import pytest

from perception.cable.following import followed_share

LINE = np.column_stack([np.arange(0.0, 201.0, 4.0), np.zeros(51)])


def test_a_line_follows_itself_and_a_shifted_one_does_not():
    assert followed_share(LINE, LINE) == 1.0
    assert followed_share(LINE, LINE + np.array([0.0, 5.0])) == 1.0
    assert followed_share(LINE, LINE + np.array([0.0, 9.0])) == 0.0


def test_a_path_that_leaves_follows_up_to_there():
    bent = np.vstack([LINE[:26], LINE[25] + (0.0, 1.0) * np.arange(1.0, 60.0)[:, None]])
    assert followed_share(LINE, bent) == pytest.approx(0.52, abs=0.05)


def test_order_counts():
    assert followed_share(LINE, LINE[::-1]) < 0.2


def test_a_detour_longer_than_the_gap_breaks_the_run():
    detour = np.vstack([LINE[:26], LINE[25] + (0.0, 40.0), LINE[26:]])
    assert followed_share(LINE, detour) == pytest.approx(0.52, abs=0.05)
    assert followed_share(LINE, detour, gap_px=120.0) == 1.0
