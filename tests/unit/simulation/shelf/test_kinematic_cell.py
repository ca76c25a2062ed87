"""The kinematic shelf cell: time, touch and mishaps of its tool; snapshots; truth."""

import numpy as np
import pytest

from executive.core.errors import DeviceError, InputError
from perception.rgbd import RgbdCamera
from perception.shelf.detections import ShelfDetector
from robots.shelf_tool import (
    VIEWPOINTS,
    Cuboid,
    LookAlong,
    LookFrom,
    PushAlong,
    PutElsewhere,
    ShelfTool,
    TakeOut,
    ToolFailure,
)
from simulation.shelf.cell import KinematicShelfCell

LUCKY = {"missed": 0.0, "lost": 0.0, "toppled": 0.0}


def cell(seed=3, **tool):
    return KinematicShelfCell({"tool": {**LUCKY, **tool}}, {"count": 8}, seed)


def done(world, action):
    world.tool.start(action)
    for _ in range(1000):
        world.advance(1)
        result = world.tool.result()
        if result is not None:
            return result
    raise AssertionError("the tool never came to an end")


def cuboid(box):
    return Cuboid(box.x_m, box.y_m, box.size_m)


def in_front(world):
    """Return an object that comes out, by name and box."""
    for name, box in world.boxes.items():
        if done(cell_like(world), TakeOut(cuboid(box))).failure is None:
            return name, box
    raise AssertionError("nothing comes out")


def cell_like(world):
    twin = cell()
    twin.restore(world.snapshot())
    return twin


def test_it_has_what_skills_ask_for():
    world = cell()
    assert isinstance(world.tool, ShelfTool)
    assert isinstance(world.camera, RgbdCamera)
    assert isinstance(world.oracle_detector, ShelfDetector)
    assert set(VIEWPOINTS) <= set(world.tool.viewpoints)


def test_an_action_takes_its_time_and_one_goes_on_at_a_time():
    world = cell()
    world.tool.start(LookFrom("left"))
    assert world.tool.result() is None
    with pytest.raises(DeviceError, match="moves"):
        world.camera.capture()
    with pytest.raises(DeviceError, match="one action at a time"):
        world.tool.start(LookFrom("right"))
    world.advance(100)
    assert world.tool.result().failure is None
    assert world.camera.capture().viewpoint == "left"


def test_an_unknown_viewpoint_is_answered_with_the_closest():
    with pytest.raises(InputError, match="'left'"):
        cell().tool.start(LookFrom("lefft"))


def test_the_camera_can_be_taken_anywhere():
    world = cell()
    T_shelf_camera = world.search_camera.T_world_camera.copy()
    T_shelf_camera[0, 3] += 0.05
    assert done(world, LookAlong(T_shelf_camera)).failure is None
    assert np.array_equal(world.camera.capture().camera.T_world_camera, T_shelf_camera)


def test_a_hold_stops_the_time_of_an_action_and_a_stop_gives_it_up():
    world = cell()
    world.tool.start(LookFrom("left"))
    world.tool.hold()
    world.advance(200)
    assert world.tool.result() is None
    assert world.tool.resting()
    world.tool.go_on()
    world.advance(200)
    assert world.tool.result() is not None
    world.tool.start(LookFrom("right"))
    world.tool.stop()
    world.advance(200)
    assert world.tool.result() is None
    assert world.tool.viewpoint == "left"


def test_after_an_emergency_stop_no_command_is_taken():
    world = cell()
    world.emergency_stop()
    with pytest.raises(DeviceError, match="emergency"):
        world.tool.start(LookFrom("left"))


def test_a_push_meets_what_stands_there_by_touch():
    world = cell(blade_m=0.0)
    name, box = in_front(world)
    before = dict(world.boxes)
    result = done(world, PushAlong(cuboid(box.at(box.x_m + 0.004, box.y_m)), 1.0))
    if result.failure is None:
        assert world.boxes[name].x_m == pytest.approx(box.x_m + result.moved_m)
        assert result.met_m == pytest.approx(1.0 - result.moved_m)
    else:
        assert dict(world.boxes) == before
    nowhere = Cuboid(0.4, -0.5, (0.01, 0.01, 0.1))
    assert done(world, PushAlong(nowhere, 0.1)).failure is ToolFailure.NOTHING_THERE


def test_what_is_taken_out_is_gone_and_told_by_the_truth():
    world = cell()
    name, box = in_front(world)
    assert done(world, TakeOut(cuboid(box))).failure is None
    assert name not in world.boxes
    assert world.truth().wrong == (() if name == world.stock.wanted else (name,))


@pytest.mark.parametrize(
    ("mishap", "failure"), [("missed", ToolFailure.MISSED), ("lost", ToolFailure.LOST)]
)
def test_mishaps_of_the_cup_leave_the_object_on_the_shelf(mishap, failure):
    world = cell(**{mishap: 1.0})
    name, box = in_front(cell())
    assert done(world, TakeOut(cuboid(box))).failure is failure
    assert name in world.boxes
    assert not world.truth().retrieved


def test_without_a_cup_nothing_is_taken():
    world = cell(suction=False)
    box = next(iter(world.boxes.values()))
    assert done(world, PutElsewhere(cuboid(box), 0.4, 0.1)).failure is ToolFailure.NO_CUP
    assert not world.tool.shape.suction


def test_a_cell_goes_on_from_a_snapshot_as_if_nothing_had_happened():
    one, other = cell(), cell()
    done(one, LookFrom("left"))
    other.restore(one.snapshot())
    looks = [done(world, LookFrom("right")) and world.camera.capture() for world in (one, other)]
    assert np.array_equal(looks[0].colour, looks[1].colour)
    assert np.array_equal(looks[0].depth_m, looks[1].depth_m, equal_nan=True)
    assert one.clock.now_s() == other.clock.now_s()
    for bad in (b"no", cell(seed=4).snapshot()):
        with pytest.raises(InputError, match="snapshot"):
            one.restore(bad)


def test_bad_settings_are_told():
    with pytest.raises(InputError, match="suction"):
        KinematicShelfCell({"tool": {"suktion": True}}, {}, 0)
    with pytest.raises(InputError, match="pharmacy"):
        KinematicShelfCell({}, {"domain": "farmacy"}, 0)
