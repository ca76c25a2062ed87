"""What a table cell's settings come to: where the robot stands, what the cable is made of."""

import numpy as np
import pytest

from robots.placement import YUMI_AT_TABLE, table_scene
from simulation.cable.parameters import RodParameters
from simulation.cable.rod import Rod
from simulation.overhead_camera import seen_rectangle
from simulation.table_cell_config import CableConfig, CameraConfig, LayoutConfig
from simulation.table_setup import planning_scene, rod_parameters
from simulation.table_world import TableWorld

LAID_M = np.column_stack([np.linspace(-0.1, 0.1, 21), np.full(21, 0.1), np.full(21, 4e-3)])


def test_nothing_set_is_the_usual_cell():
    assert planning_scene(LayoutConfig()) == table_scene()
    assert rod_parameters(CableConfig()) == RodParameters()


def test_the_robot_stands_where_the_layout_says():
    layout = LayoutConfig(robot_y_m=-0.5, body_z_m=-0.05)
    placement = planning_scene(layout).placement
    world = TableWorld(LAID_M, 240, placement)
    try:
        body_m = world.body.link_poses(("body", "left_tcp"))[0]
        usual = TableWorld(LAID_M, 240)
        moved_m = body_m - usual.body.link_poses(("body", "left_tcp"))[0]
        usual.body.close()
    finally:
        world.body.close()
    assert body_m[0] == pytest.approx([0.0, -0.5, -0.05])
    away_m = np.array(placement.position_m) - np.array(YUMI_AT_TABLE.position_m)
    assert moved_m == pytest.approx(np.vstack([away_m, away_m]), abs=1e-6)


def test_a_stiffer_cable_springs_open_farther():
    def opened_m(stiffness):
        angles = np.linspace(0.0, np.pi, 24)
        arc = 0.07 * np.column_stack([np.cos(angles), np.sin(angles), np.full(24, 0.05)])
        rod = Rod(arc, rod_parameters(CableConfig(stiffness=stiffness)))
        rod.advance(1.0)
        return np.linalg.norm(rod.positions_m[-1] - rod.positions_m[0])

    spans_m = [opened_m(stiffness) for stiffness in ("soft", "usual", "stiff")]
    assert spans_m[0] < spans_m[2]
    assert spans_m == sorted(spans_m)


def test_a_heavier_plug_pulls_more_of_the_cable_over_the_table_s_edge():
    def left_on_table(mass_kg):
        arcs = np.arange(41) * 0.01 + 0.22
        laid_m = np.column_stack([arcs, np.zeros(41), np.full(41, 0.0033)])
        rod = Rod(laid_m, rod_parameters(CableConfig(connector_mass_kg=mass_kg)))
        rod.advance(0.5)
        return int((rod.positions_m[:, 2] > 0.0).sum())

    assert left_on_table(0.06) < left_on_table(0.001)


def test_the_camera_sees_no_farther_than_the_table():
    assert seen_rectangle(CameraConfig(scale_m_px=0.01)).high_m == (0.5, 0.375)
    small = seen_rectangle(CameraConfig(scale_m_px=0.0005)).high_m
    assert small == pytest.approx((0.258, 0.19325))
