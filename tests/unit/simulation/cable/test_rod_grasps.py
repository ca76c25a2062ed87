"""What hands take, how they hold it, and when they lose it."""

import numpy as np
import pytest
from rods import carry, grasp, straight

from simulation.cable.parameters import RodParameters
from simulation.cable.rod import Rod

RADIUS_M = RodParameters().radius_m


def test_a_miss_is_a_miss():
    rod = Rod(straight(0.3))
    assert not grasp(rod, "left", "pinch", (0.15, 0.03, RADIUS_M))
    assert not grasp(rod, "left", "pinch", (0.15, 0.0, 0.03))
    assert rod.held_nodes("left") == ()
    assert rod.tension_n("left") == 0.0


def test_all_strands_between_the_fingers_are_taken():
    hairpin = np.vstack([straight(0.2), straight(0.2, start=(0.2, 0.02), along=(-1.0, 0.0))])
    rod = Rod(hairpin)
    assert grasp(rod, "left", "pinch", (0.1, 0.01, RADIUS_M))
    assert rod.held_nodes("left") == (10, 31)


@pytest.mark.parametrize("mode", ["pinch", "cage"])
def test_a_held_strand_follows_the_hand(mode):
    rod = Rod(straight(0.4, start=(-0.2, 0.0)))
    assert grasp(rod, "left", mode, (0.0, 0.0, RADIUS_M))
    carry(rod, {"left": (0.0, 0.1, 0.15)})
    gap_m = np.linalg.norm(rod.positions_m - [0.0, 0.1, 0.15], axis=1).min()
    assert gap_m < 0.006


def test_a_pinch_holds_its_node_and_lets_go_when_told():
    rod = Rod(straight(0.4, start=(-0.2, 0.0)))
    grasp(rod, "left", "pinch", (0.0, 0.0, RADIUS_M))
    carry(rod, {"left": (0.0, 0.1, 0.15)})
    np.testing.assert_allclose(rod.positions_m[20], [0.0, 0.1, 0.15], atol=1e-3)
    assert rod.held_nodes("left") == (20,)
    rod.release_hand("left")
    rod.advance(0.5)
    assert rod.positions_m[20, 2] < 0.02


def test_a_pinch_slips_at_its_force():
    rod = Rod(straight(0.6, start=(-0.3, 0.0)), RodParameters(pinch_force_n=5.0))
    grasp(rod, "left", "pinch", (-0.2, 0.0, RADIUS_M))
    grasp(rod, "right", "pinch", (0.2, 0.0, RADIUS_M))
    carry(rod, {"left": (-0.22, 0.0, 0.03), "right": (0.22, 0.0, 0.03)}, speed_m_s=0.1)
    assert rod.tension_n("left") == pytest.approx(5.0, rel=0.25)
    slipped = (rod.held_nodes("right")[0] - rod.held_nodes("left")[0]) - 40
    assert slipped >= 3


def test_a_cage_slides_along_the_cable_and_the_plug_stops_it():
    rod = Rod(straight(0.6, start=(-0.3, 0.0)))
    grasp(rod, "left", "pinch", (-0.2, 0.0, RADIUS_M))
    grasp(rod, "right", "cage", (0.0, 0.0, RADIUS_M))
    carry(rod, {"right": (0.2, 0.0, 0.02)}, speed_m_s=0.2)
    assert rod.held_nodes("right")[0] == pytest.approx(50, abs=2)
    assert rod.tension_n("left") < 2.0
    carry(rod, {"right": (0.3, 0.0, 0.02)}, speed_m_s=0.1)
    assert rod.held_nodes("right") == (58,)
    assert rod.tension_n("right") > 10.0


def test_a_pull_through_the_whole_cable_is_felt_at_once():
    rod = Rod(straight(0.6, start=(-0.3, 0.0)))
    grasp(rod, "left", "pinch", (-0.28, 0.0, RADIUS_M))
    grasp(rod, "right", "pinch", (0.28, 0.0, RADIUS_M))
    carry(rod, {"right": (0.282, 0.0, RADIUS_M)}, speed_m_s=0.1)
    assert rod.tension_n("left") == pytest.approx(rod.tension_n("right"), rel=0.2)


def test_an_overloaded_grasp_is_torn_out():
    parameters = RodParameters(pinch_force_n=1e3, overload_force_n=10.0)
    rod = Rod(straight(0.4, start=(-0.2, 0.0)), parameters)
    grasp(rod, "left", "pinch", (-0.15, 0.0, RADIUS_M))
    grasp(rod, "right", "pinch", (0.15, 0.0, RADIUS_M))
    carry(rod, {"left": (-0.3, 0.0, 0.05), "right": (0.3, 0.0, 0.05)})
    assert min(len(rod.held_nodes("left")), len(rod.held_nodes("right"))) == 0
