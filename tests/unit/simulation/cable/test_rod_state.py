"""A rod that takes up a state goes on from it bit for bit."""

import numpy as np
import pytest

from executive.core.errors import InputError
from simulation.cable.rod import Rod


def helix(turns=2.0, nodes=120, lift_m=0.03):
    """Return a loosely wound cable in the air: it falls on itself."""
    angle = np.linspace(0.0, turns * 2.0 * np.pi, nodes)
    return np.column_stack(
        [0.09 * np.cos(angle), 0.09 * np.sin(angle), lift_m + 0.006 * angle / np.pi]
    )


def rod_with_a_hand():
    rod = Rod(helix())
    rod.move_hand("left", np.diag([1.0, -1.0, -1.0, 1.0]) + 0.5 * np.eye(4, k=3)[:4])
    rod.set_capsules(np.array([[0.0, 0.09, 0.0]]), np.array([[0.0, 0.09, 0.02]]), np.array([0.01]))
    return rod


@pytest.mark.parametrize("advances", [1, 7, 20, 150])
def test_a_falling_rod_goes_on_from_its_state_bit_for_bit(advances):
    rod, other = rod_with_a_hand(), rod_with_a_hand()
    for _ in range(advances):
        rod.advance(1 / 240)
    state = rod.state()
    other.advance(1 / 240)
    other.take_state(state)
    for step in range(60):
        for each in (rod, other):
            push_m = np.array([[0.0005 * step, 0.09, 0.0]])
            each.set_capsules(push_m, push_m + np.array([0.0, 0.0, 0.02]), np.array([0.01]))
            each.advance(1 / 240)
        assert np.array_equal(rod.positions_m, other.positions_m)
        assert np.array_equal(rod.velocities_m_s, other.velocities_m_s)
        assert (rod.at_rest, rod.time_s) == (other.at_rest, other.time_s)


def test_a_state_is_a_copy():
    rod = rod_with_a_hand()
    state = rod.state()
    before = state.positions.copy()
    rod.advance(0.05)
    assert np.array_equal(state.positions, before)


def test_the_state_of_another_cable_or_of_other_hands_is_refused():
    rod = rod_with_a_hand()
    with pytest.raises(InputError, match="another cable with 60 nodes"):
        rod.take_state(_with_hand(Rod(helix(nodes=60))).state())
    with pytest.raises(InputError, match="0 hands; expected 1"):
        rod.take_state(Rod(helix()).state())


def _with_hand(rod):
    rod.move_hand("left", np.eye(4))
    return rod
