"""Pushes with the blade, by real contact."""

from dataclasses import replace

import numpy as np
import pytest
from shelf_rigs import Rig, heavy

from robots.shelf_arm.settings import ShelfArmSettings
from robots.shelf_tool import PushAlong, ToolFailure

BOX_M = (0.06, 0.06, 0.12)


@pytest.mark.parametrize("shift_m", [0.08, -0.05])
def test_box_that_is_pushed_by_a_distance_goes_that_far(shift_m: float) -> None:
    rig = Rig(heavy("a", (0.4, 0.15), BOX_M))
    before = rig.pose("a")
    result = rig.do(PushAlong(rig.thing("a"), shift_m))
    moved = rig.pose("a") - before
    assert result.failure is None
    assert result.met_m == 0.0
    assert moved[0] == pytest.approx(shift_m, abs=0.002)
    assert result.moved_m == pytest.approx(abs(shift_m), abs=0.003)
    assert abs(moved[1]) < 0.002
    assert rig.lean("a") > 0.999


def test_push_stops_at_what_stands_in_the_way() -> None:
    rig = Rig(heavy("a", (0.3, 0.15), BOX_M), heavy("b", (0.42, 0.15), BOX_M, mass_kg=0.5))
    before = rig.pose("b")[0]
    gap_m = 0.42 - 0.3 - BOX_M[0]
    result = rig.do(PushAlong(rig.thing("a"), 0.15))
    assert result.failure is None
    assert result.moved_m == pytest.approx(gap_m, abs=0.006)
    assert result.met_m == pytest.approx(0.15 - gap_m, abs=0.006)
    assert rig.pose("b")[0] - before < 0.008


def test_push_against_the_wall_ends_there_and_hurts_nothing() -> None:
    rig = Rig(heavy("a", (0.74, 0.15), BOX_M))
    result = rig.do(PushAlong(rig.thing("a"), 0.2))
    assert result.failure is None
    assert rig.pose("a")[0] == pytest.approx(0.8 - 0.03, abs=0.002)
    assert result.met_m > 0.1
    assert rig.lean("a") > 0.999


def test_blade_finds_no_room_between_boxes_and_leaves_them_standing() -> None:
    rig = Rig(heavy("a", (0.4, 0.15), BOX_M), heavy("b", (0.335, 0.1), BOX_M))
    result = rig.do(PushAlong(rig.thing("a"), 0.1))
    assert result.failure is ToolFailure.NO_BLADE_ROOM
    assert rig.lean("a") > 0.99
    assert rig.lean("b") > 0.99
    # The tool has left the shelf.
    assert rig.physics.link_pose("suction")[1] < -0.03


def test_nothing_is_there_to_push() -> None:
    rig = Rig(heavy("a", (0.6, 0.15), BOX_M))
    thing = rig.thing("a")
    missing = type(thing)(0.2, 0.15, (0.1, 0.1, 0.15))
    assert rig.do(PushAlong(missing, 0.05)).failure is ToolFailure.NOTHING_THERE


@pytest.mark.parametrize(("height_m", "topples"), [(0.042, False), (0.17, True)])
def test_tall_thin_box_topples_when_it_is_pushed_high(height_m: float, topples: bool) -> None:
    settings = ShelfArmSettings(push_height_m=height_m)
    rig = Rig(heavy("a", (0.4, 0.1), (0.035, 0.06, 0.22), friction=0.45), settings=settings)
    rig.do(PushAlong(rig.thing("a"), 0.12))
    assert (rig.lean("a") < 0.9) is topples


def test_sliding_takes_the_force_of_friction() -> None:
    rig = Rig(heavy("a", (0.4, 0.15), BOX_M, mass_kg=0.8, friction=0.35))
    rig.tool.start(PushAlong(rig.thing("a"), 0.1))
    felt = []
    while rig.tool.result() is None:
        rig.wait(0.05)
        felt.append(-rig.world.driver.force_n()[0])
    sliding = np.median([force for force in felt if force > 0.5])
    assert sliding == pytest.approx(0.35 * 0.8 * 9.81, rel=0.1)


def test_blade_that_meets_the_edge_of_the_object_itself_tries_farther_off() -> None:
    rig = Rig(heavy("a", (0.4, 0.15), BOX_M))
    seen = replace(rig.thing("a"), x_m=0.4035)
    result = rig.do(PushAlong(seen, 0.06))
    assert result.failure is None
    assert rig.pose("a")[0] == pytest.approx(0.4635, abs=0.003)
    assert rig.lean("a") > 0.999
