"""A cell that was put back goes on as if nothing had been, bit for bit."""

import json

import numpy as np
import pytest

from executive.core.errors import DeviceError, InputError
from executive.core.world import RestorableCell
from robots.dual_arm import PlannedDualArm
from robots.interfaces import TcpGoal
from simulation.table_cell import TableCell

# A loop whose upper strand is the later one.
LOOP = [
    [-0.3, -0.05, 0.004], [-0.1, -0.05, 0.004], [0.05, 0.0, 0.004], [0.1, 0.1, 0.004],
    [0.0, 0.15, 0.004], [-0.08, 0.08, 0.004], [-0.03, -0.037, 0.014], [0.1, -0.12, 0.004],
    [0.3, -0.12, 0.004],
]  # fmt: skip


@pytest.fixture
def opened(tmp_path):
    cells = []

    def open_cell(seed=3, shift_m=0.0):
        file = tmp_path / f"cable_{shift_m}.json"
        nodes_m = [[x + shift_m * (i % 2), y, z] for i, (x, y, z) in enumerate(LOOP)]
        file.write_text(json.dumps({"nodes_m": nodes_m}), encoding="utf-8")
        cells.append(TableCell({}, {"cable": {"file": str(file)}}, seed))
        return cells[-1]

    yield open_cell
    for cell in cells:
        cell.close()


def drop_cable(cell, seed):
    """Take the cable with the left hand, lift it, and let go of it."""
    arms = PlannedDualArm(cell.driver, seed=seed)
    above_m, down_m = np.array([-0.2, -0.05, 0.06]), np.array([0.0, 0.0, -0.052])
    arms.start(arms.plan({"left": TcpGoal(above_m, yaw_rad=np.pi / 2, onward_m=(down_m,))}))
    settle(cell, arms)
    arms.start(arms.plan_line({"left": down_m}))
    settle(cell, arms)
    arms.grip("left", "pinch")
    settle(cell, arms)
    assert arms.holds("left")
    arms.start(arms.plan_line({"left": -down_m}))
    settle(cell, arms)
    arms.grip("left", "open")
    settle(cell, arms)


def settle(cell, arms):
    while arms.moving():
        cell.advance(24)


def seen(cell):
    """Return everything that a mission could notice of a cell."""
    frame, state = cell.camera.capture(), cell.driver.state()
    return (
        *(frame.image, frame.depth_m, frame.stamp_s, cell.clock.now_s()),
        *(state.positions_rad, state.velocities_rad_s, *state.openings_m.values()),
        *(cell._world.rod.positions_m.copy(), cell._world.rod.velocities_m_s.copy()),
    )


def assert_equal(first, second):
    for one, other in zip(first, second, strict=True):
        assert np.array_equal(np.asarray(one), np.asarray(other), equal_nan=True)


@pytest.mark.sim
def test_a_cell_goes_on_from_its_snapshot_bit_for_bit(opened):
    original = opened()
    drop_cable(original, seed=1)
    original.camera.capture()
    snapshot = original.snapshot()
    restored = opened()
    restored.restore(snapshot)
    assert_equal(seen(original), seen(restored))
    for cell in (original, restored):
        cell.advance(120)
        drop_cable(cell, seed=2)
    assert_equal(seen(original), seen(restored))
    assert original.snapshot() == restored.snapshot()


def test_a_snapshot_survives_a_round_trip(opened):
    cell = opened()
    cell.advance(48)
    snapshot = cell.snapshot()
    cell.advance(48)
    cell.restore(snapshot)
    assert cell.clock.now_s() == 0.2
    assert cell.snapshot() == snapshot
    assert isinstance(cell, RestorableCell)


def test_streams_begin_anew_with_what_there_is(opened):
    cell = opened()
    cell.advance(48)
    snapshot = cell.snapshot()
    other = opened()
    other.restore(snapshot)
    messages = other.drain_streams()
    assert {message.topic for message in messages} == {"/joint_states", "/scene"}
    assert {message.time_s for message in messages} == {0.2}


def test_nothing_that_moves_or_holds_has_a_snapshot(opened):
    cell = opened()
    arms = PlannedDualArm(cell.driver, seed=0)
    arms.start(arms.plan({"left": TcpGoal(np.array([-0.2, 0.05, 0.1]))}))
    cell.advance(24)
    with pytest.raises(DeviceError, match="something moves"):
        cell.snapshot()
    assert not cell.driver.at_rest


def test_a_snapshot_of_another_cable_is_refused_and_changes_nothing(opened):
    cell, other = opened(), opened(shift_m=0.001)
    cell.advance(24)
    before = cell.snapshot()
    for snapshot, message in ((other.snapshot(), "another cable"), (b"no snapshot", "cannot be")):
        with pytest.raises(InputError, match=message):
            cell.restore(snapshot)
    assert cell.snapshot() == before


def test_arms_that_are_told_plan_like_those_that_have_planned_before(opened):
    cell = opened()
    goal = {"left": TcpGoal(np.array([-0.2, 0.05, 0.1]))}
    planned, told, fresh = (PlannedDualArm(cell.driver, seed=1) for _ in range(3))
    planned.plan(goal)
    told.recall(planned.memento())
    assert told.memento() == planned.memento() != fresh.memento()
    first, second = (arms.plan(goal) for arms in (planned, told))
    times_s = np.linspace(0.0, first.duration_s, 20)
    assert all(np.array_equal(first.at(t)[0], second.at(t)[0]) for t in times_s)
    with pytest.raises(InputError, match="expected the number of plans"):
        told.recall("nothing")
