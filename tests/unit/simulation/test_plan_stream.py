"""The stream of plans tells where tools go, once a motion."""

import json

import numpy as np
import pytest

from robots.dual_arm import PlannedDualArm
from robots.motion.model import yumi_model
from simulation.plan_stream import SAMPLES
from simulation.table_cell import TableCell


@pytest.fixture
def cell():
    opened = TableCell({}, {"cable": {"knot": "none"}}, 2)
    yield opened
    opened.close()


def plans(cell):
    return [json.loads(m.data) for m in cell.drain_streams() if m.topic == "/plan"]


def test_a_motion_is_told_when_it_begins_and_when_it_has_ended(cell):
    cell.advance(48)
    assert plans(cell) == []
    arms = PlannedDualArm(cell.driver, seed=0)
    up = arms.plan_line({"left": np.array([0.0, 0.0, 0.05])})
    arms.start(up)
    cell.advance(24)
    (told,) = plans(cell)
    assert list(told["tools"]) == ["left"]
    way = np.array(told["tools"]["left"])
    assert way.shape == (SAMPLES, 7)
    assert way[-1, :3] - way[0, :3] == pytest.approx([0.0, 0.0, 0.05], abs=1e-3)
    robot = yumi_model(cell.scene.placement)
    end_m = robot.tcp_pose("left", up.at(up.duration_s)[0]).translation
    assert way[-1, :3] == pytest.approx(end_m, abs=1e-4)
    while arms.moving():
        cell.advance(24)
    cell.advance(24)
    assert plans(cell) == [{"tools": {}, "duration_s": 0.0}]
