"""A cell of arms behind a socket: its own controller or one that runs, its stops and its end."""

import json

import numpy as np
import pytest

from executive.core.errors import DeviceError, InputError
from executive.core.world import Cell
from robots.dual_arm import PlannedDualArm
from simulation.loopback.cell import SocketCell
from simulation.loopback.process import LoopbackProcess
from simulation.loopback.settings import LoopbackSettings


@pytest.fixture
def opened():
    cells = []

    def open_cell(config=None, scenario=None):
        cells.append(SocketCell(config or {}, scenario or {}))
        return cells[-1]

    yield open_cell
    for cell in cells:
        cell.close()


def start_up(cell):
    arms = PlannedDualArm(cell.driver, seed=0)
    arms.start(arms.plan_line({"left": np.array([0.0, 0.0, 0.08])}))
    return arms


def test_is_a_cell_whose_arms_move_while_its_clock_goes_on(opened):
    cell = opened()
    assert isinstance(cell, Cell)
    first = cell.driver.state().positions_rad
    arms = start_up(cell)
    while arms.moving():
        cell.clock.sleep_until(cell.clock.now_s() + 0.1)
    assert np.abs(cell.driver.state().positions_rad - first).max() > 0.02
    (message,) = cell.drain_streams()
    assert json.loads(message.data)["positions"][:14] == pytest.approx(
        cell.driver.state().positions_rad, abs=1e-4
    )
    assert list(cell.drain_streams()) == []
    assert cell.truth() is None


def test_a_stop_returns_when_the_arms_rest(opened):
    cell = opened()
    start_up(cell)
    cell.clock.sleep_until(cell.clock.now_s() + 0.1)
    assert cell.driver.state().moving
    cell.stop()
    assert not cell.driver.state().moving


def test_nothing_moves_after_an_emergency_stop(opened):
    cell = opened()
    cell.emergency_stop()
    with pytest.raises(DeviceError):
        start_up(cell)


def test_a_controller_that_runs_is_used_and_left_running(opened):
    with LoopbackProcess(LoopbackSettings(lockstep=True, fresh=True)) as controller:
        address = f"{controller.host}:{controller.port}"
        for _ in range(2):
            cell = opened({"address": address})
            assert not cell.driver.state().moving
            cell.close()


@pytest.mark.parametrize(
    ("config", "scenario", "message"),
    [
        ({"adress": "a:1"}, {}, "cell config: adress: unknown key; did you mean 'address'"),
        ({"address": "nowhere"}, {}, "cell config: address: got 'nowhere'"),
        ({"address": "a:1", "controller": {}}, {}, "try leaving controller out"),
        ({"controller": {"loss": 2.0}}, {}, "cell config: controller.loss: got 2.0"),
        ({}, {"cable": {}}, "scenario: a cell of arms alone takes none; got 'cable'"),
    ],
)
def test_what_it_does_not_know_is_refused(config, scenario, message):
    with pytest.raises(InputError, match=message):
        SocketCell(config, scenario)


def test_a_controller_that_is_not_there_is_named():
    with pytest.raises(DeviceError, match=r"127\.0\.0\.1"):
        SocketCell({"address": "127.0.0.1:1"}, {})
