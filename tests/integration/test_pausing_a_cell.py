"""A mission on the simulated cell, paused while both arms are on their way."""

import json

import numpy as np
import pytest

from executive.app.catalogue import port_types, skills
from executive.core.work import InlineWorker
from executive.engine.loading.loader import load_mission
from executive.engine.nodes.builder import build
from executive.engine.recording.messages import PAUSES_TOPIC, PauseMessage
from executive.engine.running.control import RunControl
from executive.engine.running.runner import MissionOutcome, Runner
from robots.dual_arm import PlannedDualArm
from robots.interfaces import TcpGoal
from robots.motion.planner import PlannerSettings
from robots.placement import HOME_RAD
from simulation.table_cell import TableCell

MISSION = """
format: 1
mission: home
cell: yumi_table
root: {skill: go_home}
"""


class PausedOnTheWay(RunControl):
    """Goes on as soon as everything rests, and keeps where that was."""

    def __init__(self, cell):
        super().__init__()
        self.rested_rad = []
        self._cell = cell

    def wait(self, timeout_s):
        state = self._cell.driver.state()
        assert np.abs(state.velocities_rad_s).max() < 1e-3
        self.rested_rad.append(state.positions_rad)
        self.resume("the test")


class PauseWhenMoving:
    """An observer that pauses once the joints move, and keeps what is streamed."""

    def __init__(self, control, driver):
        self._control, self._driver = control, driver
        self.messages = []

    def on_tick(self, tick):
        if not self.messages and np.abs(self._driver.state().velocities_rad_s).max() > 0.3:
            self._control.pause("the test")

    def on_streams(self, messages):
        self.messages += [message for message in messages if message.topic == PAUSES_TOPIC]


@pytest.mark.sim
def test_arms_rest_in_a_pause_and_arrive_after_it(tmp_path):
    cell = TableCell({}, {"cable": {"knot": "none"}}, seed=1)
    arms = PlannedDualArm(cell.driver, seed=1, settings=PlannerSettings(speed_scale=0.5))
    places_m = {"left": (-0.2, 0.05, 0.1), "right": (0.2, 0.05, 0.1)}
    arms.start(arms.plan({arm: TcpGoal(np.array(place)) for arm, place in places_m.items()}))
    while arms.moving():
        cell.clock.sleep_until(cell.clock.now_s() + 0.1)
    (tmp_path / "home.yaml").write_text(MISSION)
    mission = load_mission(str(tmp_path / "home.yaml"), skills=skills(), types=port_types())
    devices = {"arms": arms, "worker": InlineWorker()}
    tree = build(mission, devices=devices, clock=cell.clock)
    control = PausedOnTheWay(cell)
    watch = PauseWhenMoving(control, cell.driver)
    result = Runner(tree, cell, tick_hz=10.0, observers=(watch,), control=control).run()
    assert result.outcome is MissionOutcome.SUCCESS
    assert np.abs(control.rested_rad[0] - HOME_RAD).max() > 0.05
    assert cell.driver.state().positions_rad == pytest.approx(HOME_RAD, abs=1e-3)
    paused, resumed = (PauseMessage.model_validate_json(one.data) for one in watch.messages)
    assert 0.1 < resumed.time_s - paused.time_s < 2.0
    assert json.loads(watch.messages[0].data)["leaves"] == [{"node": 0, "policy": "hold"}]
    cell.close()
