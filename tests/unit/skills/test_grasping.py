"""Grasps on image points: where the cable lies, as high as it lies, square to it."""

from dataclasses import replace

import numpy as np
import pytest
from cell_fakes import frame

from skills.cable.grasping import ABOVE_AXIS_M, HIGHEST_AXIS_M, grasp_goal
from skills.cable.heights import CABLE_RADIUS_M, axis_height_m

ALONG = np.array([1.0, 0.0])
ON_TABLE_M = CABLE_RADIUS_M + ABOVE_AXIS_M


def seen_at(top_m: float):
    """A frame of which all lies so high."""
    level = frame()
    return replace(level, depth_m=np.full(level.image.shape, 1.0 - top_m, dtype=np.float32))


@pytest.mark.parametrize("axis_m", [0.0033, 0.010, 0.03])
def test_a_hand_goes_as_high_as_the_cable_lies_and_to_where_it_is_seen(axis_m):
    there_m = np.array([0.31, -0.2, axis_m])
    seen = seen_at(axis_m + CABLE_RADIUS_M)
    (point_px,) = seen.camera.project(there_m)
    goal = grasp_goal(seen, point_px, ALONG)
    assert goal.position_m == pytest.approx(np.add(there_m, [0.0, 0.0, ABOVE_AXIS_M]), abs=1e-6)


def test_tips_never_go_into_the_table_nor_up_to_an_error_of_the_depth():
    middle_px = np.array([500.0, 375.0])
    heights_m = [
        grasp_goal(seen_at(top_m), middle_px, ALONG).position_m[2] for top_m in (-0.5, 0.0, 0.5)
    ]
    assert heights_m == pytest.approx([ON_TABLE_M, ON_TABLE_M, HIGHEST_AXIS_M + ABOVE_AXIS_M])


def test_a_wrong_pixel_of_the_depth_and_the_rim_of_the_image_are_borne():
    seen = seen_at(0.0132)
    seen.depth_m[375, 500], seen.depth_m[376, 500] = np.nan, 0.2
    assert axis_height_m(seen, np.array([500.0, 375.0])) == pytest.approx(0.0099, abs=1e-6)
    assert axis_height_m(seen, np.array([1000.4, -0.4])) == pytest.approx(0.0099, abs=1e-6)


def test_fingers_close_across_the_cable():
    goal = grasp_goal(seen_at(0.0), np.array([500.0, 375.0]), np.array([0.0, 1.0]))
    assert np.cos(goal.yaw_rad) == pytest.approx(1.0)
