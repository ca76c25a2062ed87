import hashlib
import json
import os
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from executive.core.clock import Clock
from executive.core.errors import DeviceError, InputError
from executive.core.world import Cell
from perception.camera import Camera
from robots.dual_arm import PlannedDualArm
from robots.interfaces import ArmsDriver, TcpGoal
from simulation.cable.truth import CableTruth
from simulation.table_cell import TableCell

LINE = [[-0.35, -0.05, 0.004], [-0.1, -0.05, 0.004], [0.1, -0.05, 0.004], [0.35, -0.05, 0.004]]
# A loop whose upper strand is the later one.
LOOP = [
    [-0.3, -0.05, 0.004], [-0.1, -0.05, 0.004], [0.05, 0.0, 0.004], [0.1, 0.1, 0.004],
    [0.0, 0.15, 0.004], [-0.08, 0.08, 0.004], [-0.03, -0.037, 0.014], [0.1, -0.12, 0.004],
    [0.3, -0.12, 0.004],
]  # fmt: skip


def scenario_of(nodes_m, folder):
    path = Path(folder) / "cable.json"
    path.write_text(json.dumps({"nodes_m": nodes_m}), encoding="utf-8")
    return {"cable": {"file": str(path)}}


@pytest.fixture
def cell(tmp_path):
    cell = TableCell({}, scenario_of(LINE, tmp_path), seed=5)
    yield cell
    cell.close()


def start_motion(cell, seed=0):
    arms = PlannedDualArm(cell.driver, seed=seed)
    places_m = {"left": (-0.2, 0.05, 0.1), "right": (0.2, 0.05, 0.1)}
    arms.start(arms.plan({arm: TcpGoal(np.array(place)) for arm, place in places_m.items()}))
    return arms


def test_is_a_cell_with_the_devices_that_it_names(cell):
    assert isinstance(cell, Cell)
    assert isinstance(cell.devices["clock"], Clock)
    assert isinstance(cell.devices["camera"], Camera)
    assert isinstance(cell.devices["driver"], ArmsDriver)


def test_refuses_what_it_does_not_know():
    with pytest.raises(InputError, match=r"scenario: cable\.knott: unknown key; did you mean"):
        TableCell({}, {"cable": {"knott": "none"}}, seed=0)
    with pytest.raises(InputError, match="cell config: kamera"):
        TableCell({"kamera": {}}, {}, seed=0)


def test_truth_is_about_the_cable_as_it_lies(tmp_path):
    cell = TableCell({}, scenario_of(LOOP, tmp_path), seed=0)
    assert cell.truth() == CableTruth(untangled=True, crossings=1)
    cell.close()


def test_joint_states_are_recorded_while_the_arms_move_and_only_then(cell):
    cell.clock.sleep_until(1.0)
    list(cell.drain_streams())
    cell.clock.sleep_until(2.0)
    assert [m for m in cell.drain_streams() if m.topic == "/joint_states"] == []
    start_motion(cell)
    cell.clock.sleep_until(2.5)
    messages = [m for m in cell.drain_streams() if m.topic == "/joint_states"]
    assert len(messages) == 10
    assert np.diff([m.time_s for m in messages]) == pytest.approx(0.05)
    joints = json.loads(messages[-1].data)
    assert len(joints["names"]) == len(joints["positions"]) == len(joints["velocities"]) == 16
    assert joints["positions"][:14] == pytest.approx(cell.driver.state().positions_rad, abs=1e-5)


def test_scenes_tell_where_links_and_cable_are(cell):
    start_motion(cell)
    cell.clock.sleep_until(1.0)
    scenes = [m for m in cell.drain_streams() if m.topic == "/scene"]
    assert 5 <= len(scenes) <= 6
    scene = json.loads(scenes[-1].data)
    assert len(scene["links"]["left_tcp"]) == 7
    assert scene["cable_radius_m"] == pytest.approx(0.0033)
    nodes = np.array(scene["cable_nodes_m"])
    assert nodes.shape[1] == 3
    assert nodes * 1e4 == pytest.approx(np.round(nodes * 1e4), abs=1e-6)


def test_messages_come_in_the_order_of_time_and_once(cell):
    start_motion(cell)
    cell.clock.sleep_until(0.5)
    times = [m.time_s for m in cell.drain_streams()]
    assert times == sorted(times)
    assert list(cell.drain_streams()) == []


@pytest.mark.parametrize("stop", ["stop", "emergency_stop"])
def test_a_stop_brings_the_arms_to_rest(cell, stop):
    arms = start_motion(cell)
    cell.clock.sleep_until(0.3)
    getattr(cell, stop)()
    state = cell.driver.state()
    assert not state.moving
    assert np.abs(state.velocities_rad_s).max() < 1e-3
    assert not arms.moving()
    now_s = cell.clock.now_s()
    getattr(cell, stop)()
    assert cell.clock.now_s() == now_s


def test_an_emergency_stop_from_another_thread_stops_a_world_that_goes_on(cell):
    arms = start_motion(cell)
    braked_s = []

    def light_curtain():
        while cell.clock.now_s() < 0.2:
            time.sleep(0.001)
        cell.emergency_stop()
        braked_s.append(cell.clock.now_s())

    thread = threading.Thread(target=light_curtain)
    thread.start()
    cell.clock.sleep_until(30.0)  # the thread that ticks is far away
    thread.join(30.0)
    assert braked_s[0] < 5.0
    assert cell.clock.now_s() == pytest.approx(30.0)
    assert not arms.moving()
    with pytest.raises(DeviceError, match="an emergency stop was made"):
        start_motion(cell)


def test_an_emergency_stop_waits_for_nobody_who_hangs(cell):
    start_motion(cell)
    cell.clock.sleep_until(0.3)
    thread = threading.Thread(target=cell.emergency_stop)  # this one ticks, and does nothing
    thread.start()
    thread.join(30.0)
    assert not cell.driver.state().moving


def test_the_camera_sees_the_cable_and_what_stands_in_the_way(cell):
    before = cell.camera.capture()
    assert before.image.shape == (773, 1032)
    assert before.image.dtype == np.uint8
    assert before.depth_m.dtype == np.float32
    start_motion(cell)
    cell.clock.sleep_until(2.0)
    after = cell.camera.capture()
    assert after.stamp_s == pytest.approx(2.0)
    tool_m = PlannedDualArm(cell.driver, seed=0).tcp_position("left")
    (u, v) = np.round(after.camera.project(tool_m[None])[0]).astype(int)
    assert after.depth_m[v, u] < before.depth_m[v, u] - 0.1


def digest_of_run(folder, seed):
    """Pinch the cable, lift it aside, and hash all that can be seen of that."""
    cell = TableCell({}, scenario_of(LINE, folder), seed)
    digest = hashlib.sha256(cell.camera.capture().image.tobytes())
    arms = PlannedDualArm(cell.driver, seed=0)
    arms.start(arms.plan({"left": TcpGoal(np.array([-0.2, -0.05, 0.06]), 0.5 * np.pi)}))
    cell.clock.sleep_until(1.5)
    arms.start(arms.plan_line({"left": np.array([0.0, 0.0, -0.052])}))
    cell.clock.sleep_until(2.5)
    arms.grip("left", "pinch")
    cell.clock.sleep_until(3.5)
    assert arms.holds("left")
    arms.start(arms.plan_line({"left": np.array([0.0, 0.05, 0.06])}))
    cell.clock.sleep_until(4.5)
    frame = cell.camera.capture()
    for part in (frame.image, frame.depth_m, cell.driver.state().positions_rad):
        digest.update(part.tobytes())
    for message in cell.drain_streams():
        digest.update(message.data)
    cell.close()
    return digest.hexdigest()


def test_the_same_seed_gives_the_same_run_to_the_bit_in_another_process(tmp_path):
    code = f"import test_table_cell as t; print(t.digest_of_run({str(tmp_path)!r}, 1))"
    here = Path(__file__).parent
    path = os.pathsep.join([str(here), str(here.parents[2])])
    other = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": path},
        check=True, capture_output=True, text=True,
    )  # fmt: skip
    assert other.stdout.strip() == digest_of_run(tmp_path, 1)


def test_another_seed_gives_another_image(cell, tmp_path):
    other = TableCell({}, scenario_of(LINE, tmp_path), seed=6)
    assert not np.array_equal(cell.camera.capture().image, other.camera.capture().image)
    other.close()
