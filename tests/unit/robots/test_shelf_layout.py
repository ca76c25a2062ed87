"""The place of an arm before a shelf is judged by what its tool reaches, and by what is seen."""

import numpy as np
import pytest
from PIL import Image

from robots.shelf_arm import layout
from robots.shelf_arm.layout import judge_shelf, shelf_grid, without_arm
from robots.shelf_arm.scene import ShelfSize
from robots.viewer.shelf_picture import save_shelf

SHELF = ShelfSize()
SEEN = np.ones((4, 8), dtype=bool)


def camera_at(x, y, z=0.2):
    T = np.eye(4)
    T[:3, :3] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]
    T[:3, 3] = x, y, z
    return T


VIEWPOINTS = {"centre": camera_at(0.4, -0.75), "far": camera_at(0.4, -3.0)}


@pytest.fixture
def measured(monkeypatch):
    """Let a test say how deep the tool gets, near the floor and higher up."""

    def told(low_m, high_m):
        def reached(_solver, x_m, y_m, height_m):
            deep_m = low_m if height_m == layout.LOW_M else high_m
            return np.repeat((y_m < deep_m)[:, None], len(x_m), axis=1)

        monkeypatch.setattr(layout, "_reached", reached)

    return told


def judge(seen=SEEN, viewpoints=VIEWPOINTS, shelf=SHELF):
    return judge_shelf(shelf, viewpoints, seen, 0.1)


def test_the_grid_covers_the_floor_but_for_its_edges():
    x_m, y_m = shelf_grid(SHELF, 0.1)
    assert (x_m[0], x_m[-1], y_m[0], y_m[-1]) == pytest.approx((0.05, 0.75, 0.05, 0.30))
    assert np.diff(x_m) == pytest.approx(0.1, abs=0.02)


def test_the_kinova_reaches_its_own_shelf_but_no_viewpoint_three_metres_away():
    report = judge_shelf(SHELF, VIEWPOINTS, SEEN, 0.35)
    assert report.works
    assert report.low.all()
    assert report.viewpoints == {"centre": True, "far": False}
    assert report.warnings == ("the camera does not reach the viewpoint far",)


def test_a_shelf_that_is_too_deep_for_the_arm_does_not_work():
    report = judge_shelf(ShelfSize(0.8, 1.2, 0.57), VIEWPOINTS, SEEN, 0.35)
    assert not report.works
    assert "% of the shelf is reached near its floor; expected 90 % or more" in report.warnings[0]


def test_what_is_not_reached_higher_up_is_only_a_warning(measured):
    measured(1.0, 0.1)
    report = judge()
    assert report.works
    assert "0.20 m above its floor" in report.warnings[0]
    assert report.rows()[0].endswith("oooooooo")
    assert report.rows()[-1].endswith("########")


def test_without_a_viewpoint_nothing_works(measured):
    measured(1.0, 1.0)
    report = judge(viewpoints={"far": VIEWPOINTS["far"]})
    assert not report.works
    assert "the camera reaches no viewpoint: nothing is seen" in report.warnings


def test_a_floor_that_is_not_seen_is_told(measured):
    measured(1.0, 1.0)
    assert any("the camera sees 0 %" in warning for warning in judge(seen=~SEEN).warnings)


def test_a_tool_without_an_arm_gets_everywhere():
    report = without_arm(SHELF, VIEWPOINTS, SEEN, 0.1)
    assert report.works
    assert report.shares() == {"low": 1.0, "high": 1.0, "seen": 1.0}


@pytest.mark.parametrize("with_arm", [True, False])
def test_the_picture_shows_reach_and_cameras(measured, tmp_path, with_arm):
    measured(0.2, 0.2)
    x_m, y_m = shelf_grid(SHELF, 0.1)
    report = judge(seen=np.ones((len(y_m), len(x_m)), dtype=bool))
    file = tmp_path / "runs" / "shelf.png"
    save_shelf(report, SHELF, VIEWPOINTS, "a shelf", file, with_arm=with_arm)
    with Image.open(file) as image:
        colours = {colour for _, colour in image.convert("RGB").getcolors(1 << 20)}
    assert {(0x4F, 0x9D, 0x5D), (0xD0, 0x34, 0x2C)} <= colours
    assert ((0x8A, 0x8A, 0x8E) in colours) == with_arm
