"""Several cables in one world: each for itself until they touch, and then with contact."""

import numpy as np
import pytest
from rods import carry, grasp, straight

from executive.core.errors import InputError
from simulation.cable.parameters import RodParameters
from simulation.cable.rod import Rod

RADIUS_M = RodParameters().radius_m


def crossed(apart_m=2.2 * RADIUS_M):
    """Return two straight cables, the second laid across the first."""
    first = straight(0.4, start=(-0.2, 0.0))
    second = straight(0.4, start=(0.0, -0.2), along=(0.0, 1.0), z_m=RADIUS_M + apart_m)
    return first, second


def nearest_m(first, second):
    return np.linalg.norm(first[:, None] - second[None], axis=2).min()


def test_cables_that_never_touch_move_as_each_would_alone():
    lines = straight(0.3, z_m=0.05, start=(0.1, -0.2)), straight(0.5, start=(-0.3, 0.2))
    both, alone = Rod(lines), [Rod(line) for line in lines]
    for rod in (both, alone[0]):
        grasp(rod, "left", "pinch", (0.2, -0.2, 0.05))
        carry(rod, {"left": (0.1, -0.1, 0.1)})
    alone[1].advance(both.time_s)
    for line, single in zip(both.lines_m, alone, strict=True):
        assert line == pytest.approx(single.positions_m, abs=1e-6)
    assert both.length_m == pytest.approx(0.8, rel=1e-3)


def test_the_last_node_of_one_does_not_pull_on_the_first_of_the_next():
    lines = straight(0.2, start=(-0.3, 0.0)), straight(0.2, start=(0.1, 0.0))
    rod = Rod(lines)
    grasp(rod, "left", "pinch", (-0.11, 0.0, RADIUS_M))
    carry(rod, {"left": (-0.16, 0.1, 0.06)})
    assert rod.lines_m[1] == pytest.approx(lines[1], abs=1e-3)
    assert np.abs(rod.tensions_n[21:]).max() < 0.05


def test_the_lower_of_two_crossed_cables_carries_the_upper_one():
    rod = Rod(crossed())
    rod.advance(0.3)
    assert grasp(rod, "left", "pinch", (-0.05, 0.0, RADIUS_M))
    assert grasp(rod, "right", "pinch", (0.05, 0.0, RADIUS_M))
    carry(rod, {"left": (-0.05, 0.0, 0.08), "right": (0.05, 0.0, 0.08)})
    lower, upper = rod.lines_m
    assert upper[20, 2] > lower[20, 2] > 0.06
    assert nearest_m(lower, upper) > 1.8 * RADIUS_M


def test_a_cable_that_is_dragged_over_another_never_passes_through_it():
    rod = Rod(crossed())
    rod.advance(0.3)
    assert grasp(rod, "left", "pinch", (0.0, -0.15, RADIUS_M))
    assert grasp(rod, "right", "pinch", (0.0, 0.15, RADIUS_M))
    for way in (0.08, -0.08, 0.0):
        target = {"left": (way, -0.15, RADIUS_M), "right": (way, 0.15, RADIUS_M)}
        carry(rod, target, speed_m_s=1.0)
        lower, upper = rod.lines_m
        assert nearest_m(lower, upper) > 1.6 * RADIUS_M
        assert upper[20, 2] > RADIUS_M + 1.5 * RADIUS_M


def test_a_hand_takes_strands_of_both_cables_and_pulls_both():
    lines = straight(0.4, start=(-0.2, 0.0)), straight(0.4, start=(-0.2, 0.012))
    rod = Rod(lines)
    assert grasp(rod, "left", "pinch", (0.0, 0.006, RADIUS_M))
    assert rod.held_nodes("left") == (20, 61)
    carry(rod, {"left": (0.0, 0.006, 0.1)})
    assert rod.positions_m[[20, 61], 2] == pytest.approx([0.1, 0.1], abs=0.005)


def test_a_cage_at_the_end_of_the_first_cable_stops_at_its_plug():
    lines = straight(0.4, start=(-0.2, 0.0)), straight(0.4, start=(-0.2, 0.15))
    rod = Rod(lines)
    grasp(rod, "left", "pinch", (-0.1, 0.0, RADIUS_M))
    grasp(rod, "right", "cage", (0.1, 0.0, RADIUS_M))
    carry(rod, {"right": (0.23, 0.0, 0.02)}, speed_m_s=0.2)
    assert rod.held_nodes("right") == (38,)
    assert rod.tension_n("right") > 10.0


def test_each_cable_has_two_plugs():
    rod = Rod((straight(0.3), straight(0.3, start=(0.0, 0.1))))
    poses = rod.connector_poses()
    assert poses.shape == (4, 4, 4)
    assert poses[:, 0, 0] == pytest.approx([-1.0, 1.0, -1.0, 1.0])
    assert poses[:, 1, 3] == pytest.approx([0.0, 0.0, 0.1, 0.1])


def test_two_cables_go_on_from_their_state_and_refuse_that_of_one():
    rods = [Rod(crossed(0.03)) for _ in range(2)]
    for _ in range(10):
        rods[0].advance(1 / 240)
    rods[1].take_state(rods[0].state())
    for rod in rods:
        rod.advance(0.2)
    assert np.array_equal(rods[0].positions_m, rods[1].positions_m)
    with pytest.raises(InputError, match="another cable"):
        rods[0].take_state(Rod(straight(0.81)).state())


def test_no_cable_at_all_is_refused():
    with pytest.raises(InputError, match="got no cable"):
        Rod(())
