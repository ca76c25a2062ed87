"""A layout is judged by who reaches what: what cannot work is said, and what to try."""

import numpy as np
import pytest
from PIL import Image

from robots import layout
from robots.layout import judge_layout
from robots.placement import (
    TABLE_SIZE_M,
    YUMI_AT_TABLE,
    Placement,
    PlanningScene,
    Rectangle,
    table_scene,
    table_top,
)
from robots.reach import ReachMap
from robots.viewer.reach_picture import draw_reach, save_reach

ALL = Rectangle((-0.5, -0.375), (0.5, 0.375))


@pytest.fixture
def measured(monkeypatch):
    """Let a test say who reaches what, instead of measuring it."""

    def told(left, right):
        def reach_map(_scene, x_m, y_m, **_):
            x, y = np.meshgrid(x_m, y_m)
            share = {"left": left(x, y), "right": right(x, y)}
            return ReachMap(x_m, y_m, {arm: mask.astype(float) for arm, mask in share.items()})

        monkeypatch.setattr(layout, "reach_map", reach_map)

    return told


def test_a_layout_that_reaches_its_work_area_works(measured):
    measured(lambda x, _: x < 0.3, lambda x, _: x > -0.3)
    report = judge_layout(table_scene(), ALL, 0.1)
    assert report.works
    assert report.warnings == ()
    shares = report.shares()
    assert shares["one"] == 1.0
    assert shares["both"] == pytest.approx(shares["left"] + shares["right"] - 1.0)


def test_too_little_of_the_work_area_is_a_fault(measured):
    measured(lambda x, y: (x < 0.1) & (y < -0.1), lambda x, y: (x > -0.1) & (y < -0.1))
    report = judge_layout(table_scene(), ALL, 0.1)
    assert not report.works
    assert "of the work area" in report.warnings[0]


def test_hands_that_never_meet_are_a_fault(measured):
    measured(lambda x, _: x < 0.0, lambda x, _: x >= 0.0)
    report = judge_layout(table_scene(), ALL, 0.1)
    assert not report.works
    assert "no place" in report.warnings[0]


def test_a_camera_that_sees_too_little_is_a_warning(measured):
    measured(lambda x, _: x < 0.3, lambda x, _: x > -0.3)
    report = judge_layout(table_scene(), Rectangle((-0.2, -0.2), (0.2, 0.2)), 0.1)
    assert report.works
    assert "the camera sees" in report.warnings[0]


def test_a_robot_that_stands_in_its_table_cannot_begin(measured):
    measured(lambda x, _: x < 0.3, lambda x, _: x > -0.3)
    low = Placement((0.0, -0.36, -0.30), YUMI_AT_TABLE.yaw_rad)
    report = judge_layout(PlanningScene(low, (table_top(),)), ALL, 0.1)
    assert not report.works
    assert "at home, " in report.warnings[0]
    assert "table" in report.warnings[0]


def test_an_arm_that_does_nothing_is_named(measured):
    measured(lambda x, _: x > -1.0, lambda x, _: x > 1.0)
    warnings = judge_layout(table_scene(), ALL, 0.1).warnings
    assert any("the right arm reaches nothing" in warning for warning in warnings)


def test_the_picture_shows_each_arm_where_it_grasps(measured, tmp_path):
    measured(lambda x, _: x < 0.15, lambda x, _: x > -0.15)
    report = judge_layout(table_scene(), ALL, 0.1)
    image = draw_reach(report, YUMI_AT_TABLE, "a cell")
    width, height = image.size
    assert width > 700 * TABLE_SIZE_M[0]

    def colour(x_m, y_m):
        return image.getpixel((round(60 + (x_m + 0.5) * 700), round(60 + (0.375 - y_m) * 700)))

    assert colour(-0.31, 0.01) == (0x3B, 0x82, 0xC4)
    assert colour(0.31, 0.01) == (0xD9, 0x82, 0x2B)
    assert colour(0.01, 0.01) == (0x4F, 0x9D, 0x5D)
    save_reach(report, YUMI_AT_TABLE, "a cell", tmp_path / "deep" / "reach.png")
    with Image.open(tmp_path / "deep" / "reach.png") as written:
        assert written.size == (width, height)
