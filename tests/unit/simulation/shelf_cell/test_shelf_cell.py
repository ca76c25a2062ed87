"""The shelf cell as a runner and skills use it."""

import json
import threading

import numpy as np
import pytest
from shelf_rigs import Rig, heavy

from executive.core.errors import DeviceError, InputError
from executive.core.world import Cell
from perception.rgbd import RgbdCamera
from perception.shelf.types import Shelf
from robots.shelf_tool import VIEWPOINTS, LookFrom, PutElsewhere, ShelfTool, ToolFailure
from simulation.shelf_cell.cell import ShelfCell

SCENARIO = {"count": 8}


@pytest.fixture
def cell():
    cell = ShelfCell({}, SCENARIO, 1)
    yield cell
    cell.close()


def wait(cell: ShelfCell, duration_s: float) -> None:
    cell.clock.sleep_until(cell.clock.now_s() + duration_s)


def finish(cell: ShelfCell) -> None:
    while cell.tool.result() is None:
        wait(cell, 0.1)


def test_cell_offers_what_runners_and_skills_ask_for(cell: ShelfCell) -> None:
    assert isinstance(cell, Cell)
    assert isinstance(cell.tool, ShelfTool)
    assert isinstance(cell.camera, RgbdCamera)
    assert set(VIEWPOINTS) <= set(cell.tool.viewpoints)


def test_looks_are_taken_from_where_the_viewpoint_is(cell: ShelfCell) -> None:
    for viewpoint in VIEWPOINTS:
        cell.tool.start(LookFrom(viewpoint))
        finish(cell)
        frame = cell.camera.capture()
        assert frame.viewpoint == viewpoint
        middle = frame.camera.T_world_camera[:3, 3]
        assert middle[1] == pytest.approx(-0.75, abs=2e-3)
        assert middle[2] == pytest.approx(0.2, abs=2e-3)


def test_depth_tells_where_the_back_of_the_shelf_is() -> None:
    rig_free = ShelfCell({"camera": {"depth_noise_m": 0.0, "lost_share": 0.0}}, SCENARIO, 1)
    frame = rig_free.camera.capture()
    row, column = frame.camera.height_px // 3, frame.camera.width_px // 2
    distance_m = Shelf().depth_m - frame.camera.T_world_camera[1, 3]
    assert frame.depth_m[row, column] == pytest.approx(distance_m, abs=2e-3)
    rig_free.close()


def test_camera_that_is_badly_calibrated_sees_elsewhere_than_it_says() -> None:
    exact = {"depth_noise_m": 0.0, "lost_share": 0.0}
    frames = []
    for error in ({}, {"calibration_m": 0.01, "calibration_rad": 0.02}):
        cell = ShelfCell({"camera": {**exact, **error}}, SCENARIO, 1)
        frames.append(cell.camera.capture())
        cell.close()
    assert np.array_equal(frames[0].camera.T_world_camera, frames[1].camera.T_world_camera)
    assert np.nanmean(np.abs(frames[0].depth_m - frames[1].depth_m)) > 1e-3


def test_dropped_frames_and_moving_cameras_are_errors() -> None:
    cell = ShelfCell({"camera": {"drop_share": 1.0}}, SCENARIO, 1)
    with pytest.raises(DeviceError, match="dropped"):
        cell.camera.capture()
    cell.tool.start(LookFrom("left"))
    wait(cell, 0.3)
    with pytest.raises(DeviceError, match="moves"):
        cell.camera.capture()
    cell.close()


def test_one_action_at_a_time_and_known_viewpoints(cell: ShelfCell) -> None:
    with pytest.raises(InputError, match="unknown viewpoint 'lef'"):
        cell.tool.start(LookFrom("lef"))
    cell.tool.start(LookFrom("left"))
    with pytest.raises(DeviceError, match="under way"):
        cell.tool.start(LookFrom("right"))


def test_hold_rests_on_the_way_and_goes_on(cell: ShelfCell) -> None:
    cell.tool.start(LookFrom("left"))
    wait(cell, 0.4)
    cell.tool.hold()
    wait(cell, 2.0)
    assert cell.tool.resting()
    assert cell.tool.result() is None
    there = cell.driver.state().positions_rad
    wait(cell, 1.0)
    assert np.allclose(cell.driver.state().positions_rad, there, atol=1e-4)
    cell.tool.go_on()
    finish(cell)
    result = cell.tool.result()
    assert result is not None
    assert result.failure is None


def test_stop_gives_the_action_up(cell: ShelfCell) -> None:
    cell.tool.start(LookFrom("left"))
    wait(cell, 0.4)
    cell.stop()
    assert cell.tool.resting()
    assert cell.tool.result() is None
    cell.tool.start(LookFrom("right"))
    finish(cell)
    assert cell.camera.capture().viewpoint == "right"


def test_emergency_stop_from_another_thread_ends_all_motion(cell: ShelfCell) -> None:
    cell.tool.start(LookFrom("left"))
    wait(cell, 0.4)
    stopper = threading.Thread(target=cell.emergency_stop)
    stopper.start()
    wait(cell, 0.5)
    stopper.join()
    assert cell.driver.at_rest
    there = cell.driver.state().positions_rad
    cell.tool.start(LookFrom("right"))
    finish(cell)
    result = cell.tool.result()
    assert result is not None
    assert result.failure is ToolFailure.NO_PATH
    assert "emergency stop" in result.text
    assert np.allclose(cell.driver.state().positions_rad, there, atol=1e-4)


def test_what_a_stop_leaves_in_the_cups_goes_back_first() -> None:
    rig = Rig(heavy("a", (0.4, 0.15), (0.06, 0.06, 0.12)))
    rig.tool.start(PutElsewhere(rig.thing("a"), 0.6, 0.2))
    while not rig.world.driver.holds():
        rig.wait(0.1)
    rig.wait(1.0)
    rig.tool.stop()
    while not rig.tool.resting():
        rig.wait(0.1)
    assert rig.world.driver.holds()
    assert rig.do(LookFrom("centre")).failure is None
    assert not rig.world.driver.holds()
    assert rig.pose("a")[:2] == pytest.approx((0.4, 0.15), abs=0.008)


def test_streams_tell_joints_and_boxes(cell: ShelfCell) -> None:
    cell.tool.start(LookFrom("left"))
    finish(cell)
    messages = list(cell.drain_streams())
    assert {message.schema for message in messages} == {"JointStates", "Plan", "ShelfScene"}
    assert [message.time_s for message in messages] == sorted(m.time_s for m in messages)
    scene = json.loads(next(m.data for m in messages if m.schema == "ShelfScene"))
    assert set(scene["boxes"]) == set(cell.truth().poses) == set(scene["sizes_m"])
    assert "suction" in scene["links"]
    assert list(cell.drain_streams()) == []


@pytest.mark.parametrize(
    ("config", "scenario", "message"),
    [
        ({"camera": {"widht_px": 160}}, {}, "widht_px: unknown key"),
        ({"tool": {"lane_m": 0.5}}, {}, "lane_m: got 0.5"),
        ({"matter": {"density_kg_m3": [500.0, 100.0]}}, {}, "expected low <= high"),
        ({}, {"domain": "pharmcy"}, "pharmacy"),
        ({}, {"count": 1}, "count: got 1"),
    ],
)
def test_bad_settings_are_refused(config: dict, scenario: dict, message: str) -> None:
    with pytest.raises(InputError, match=message):
        ShelfCell(config, scenario, 0)
