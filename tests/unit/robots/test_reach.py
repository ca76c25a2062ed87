"""The reach map says who reaches what."""

import numpy as np

from robots.placement import table_scene
from robots.reach import reach_map


def test_each_arm_reaches_its_side_and_none_the_far_edge():
    found = reach_map(table_scene(), np.array([-0.45, 0.0, 0.45]), np.array([0.0, 0.36]), yaws=2)
    reached = found.reached()
    assert reached["left"][0].tolist() == [True, True, False]
    assert reached["right"][0].tolist() == [False, True, True]
    assert not reached["left"][1].any()
    assert found.rows() == ["  0.36 ...", "  0.00 LBR"]
