"""Laws of mechanics that the rod must keep, whatever its solver does."""

import numpy as np
import pytest
from rods import carry, floating, grasp, straight, tool

from executive.core.errors import InputError
from simulation.cable.parameters import RodParameters
from simulation.cable.rod import Rod


def test_free_fall_follows_gravity():
    rod = Rod(straight(0.4, z_m=1.0), RodParameters(air_damping_1_s=0.0))
    rod.advance(0.3)
    fallen_m = 1.0 - rod.positions_m[:, 2]
    np.testing.assert_allclose(fallen_m, 0.5 * 9.81 * 0.3**2, rtol=2e-3)


def test_momentum_is_conserved_while_a_bent_rod_springs_open():
    angles = np.linspace(0.0, np.pi, 31)
    arc_m = 0.1 * np.column_stack([np.cos(angles), np.sin(angles), np.full(31, 5.0)])
    rod = Rod(arc_m, floating(connector_mass_kg=0.0, air_damping_1_s=0.0))
    masses = np.r_[0.5, np.ones(29), 0.5]
    before_m = masses @ rod.positions_m
    rod.advance(0.5)
    assert np.ptp(rod.positions_m[:, 1]) < 0.09
    np.testing.assert_allclose(masses @ rod.positions_m, before_m, atol=1e-9)


def test_a_cable_at_rest_stays_and_keeps_its_energy():
    rod = Rod(straight(0.4, along=(0.6, 0.8)), RodParameters(rest_speed_m_s=0.0))
    rod.advance(0.2)
    energy_j, nodes_m = rod.energy_j(), rod.positions_m.copy()
    rod.advance(1.0)
    assert rod.energy_j() == pytest.approx(energy_j, rel=1e-3)
    np.testing.assert_allclose(rod.positions_m, nodes_m, atol=1e-5)


def test_dropped_cable_loses_energy_and_comes_to_rest():
    angles = np.linspace(0.0, 4.0, 61)
    radii = 0.08 + 0.01 * angles
    curve = np.column_stack([radii * np.cos(angles), radii * np.sin(angles), 0.05 + 0 * angles])
    rod = Rod(curve)
    energies_j = [rod.energy_j()]
    while not rod.at_rest and rod.time_s < 4.0:
        rod.advance(0.1)
        energies_j.append(rod.energy_j())
    assert rod.at_rest
    assert np.diff(energies_j).max() < 1e-3 * energies_j[0]
    assert rod.positions_m[:, 2].min() > 0.9 * rod.parameters.radius_m


def test_length_is_kept_while_a_hand_drags_the_cable_at_full_speed():
    rod = Rod(straight(1.0, start=(-0.45, 0.0)))
    length_m = rod.length_m
    assert grasp(rod, "left", "pinch", (0.5, 0.0, 0.0033))
    for target_m in ((0.2, 0.3, 0.1), (-0.3, -0.2, 0.05), (0.4, 0.0, 0.2)):
        carry(rod, {"left": target_m}, speed_m_s=1.0)
        assert rod.length_m == pytest.approx(length_m, rel=5e-3)


def test_hangs_as_a_catenary():
    rod = Rod(
        straight(1.0, z_m=1.0, start=(-0.5, 0.0)),
        RodParameters(bending_stiffness_n_m2=1e-6, connector_mass_kg=0.0, air_damping_1_s=3.0),
    )
    for hand, x_m in (("left", -0.5), ("right", 0.5)):
        assert grasp(rod, hand, "pinch", (x_m, 0.0, 1.0))
    carry(rod, {"left": (-0.35, 0.0, 1.0), "right": (0.35, 0.0, 1.0)})
    rod.advance(2.0)
    # span = 2 a asinh(length / 2 a), sag = a (cosh(span / 2 a) - 1)
    a_m = np.linspace(0.05, 1.0, 100_000)
    a_m = a_m[np.argmin(np.abs(2.0 * a_m * np.arcsinh(0.5 / a_m) - 0.7))]
    sag_m = 1.0 - rod.positions_m[:, 2].min()
    assert sag_m == pytest.approx(a_m * (np.cosh(0.35 / a_m) - 1.0), rel=0.02)
    horizontal_n = rod.parameters.density_kg_m * 9.81 * a_m
    assert rod.tensions_n[50] == pytest.approx(horizontal_n, rel=0.03)


def test_bends_under_its_weight_as_a_beam_on_two_supports():
    parameters = RodParameters(
        connector_mass_kg=0.0,
        connector_length_m=0.0,
        cage_clearance_m=0.0,
        friction_cage=0.0,
        air_damping_1_s=5.0,
        bending_stiffness_n_m2=2e-4,
    )
    rod = Rod(straight(0.16, z_m=1.0, start=(-0.08, 0.0)), parameters)
    assert grasp(rod, "left", "pinch", (-0.06, 0.0, 1.0))
    assert grasp(rod, "right", "cage", (0.06, 0.0, 1.0))
    rod.advance(1.5)
    weight_n_m, stiffness = parameters.density_kg_m * 9.81, parameters.bending_stiffness_n_m2
    span_m, over_m = 0.12, 0.02
    sag_m = weight_n_m * span_m**2 * (5 * span_m**2 - 24 * over_m**2) / (384 * stiffness)
    sagged_m = rod.positions_m[[2, 14], 2].mean() - rod.positions_m[8, 2]
    assert sagged_m == pytest.approx(sag_m, rel=0.05)


@pytest.mark.parametrize("substep_s", [2.5e-4, 1e-4])
def test_droops_beyond_its_supports_as_a_beam_however_long_the_steps(substep_s):
    parameters = RodParameters(
        connector_mass_kg=0.0,
        connector_length_m=0.0,
        cage_clearance_m=0.0,
        friction_cage=0.0,
        air_damping_1_s=5.0,
        bending_stiffness_n_m2=5e-4,
        substep_s=substep_s,
    )
    between_m, out_m = 0.06, 0.08
    rod = Rod(straight(between_m + out_m, z_m=1.0), parameters)
    assert grasp(rod, "root", "pinch", (0.0, 0.0, 1.0))
    assert grasp(rod, "edge", "cage", (between_m, 0.0, 1.0))
    rod.advance(2.0)
    weight_n_m = parameters.density_kg_m * parameters.gravity_m_s2
    cubes = 3.0 * out_m**3 + 4.0 * out_m**2 * between_m - between_m**3
    droop_m = weight_n_m * out_m * cubes / (24.0 * parameters.bending_stiffness_n_m2)
    assert rod.positions_m[6, 2] - rod.positions_m[-1, 2] == pytest.approx(droop_m, rel=0.03)


def test_dragging_a_cable_takes_its_friction():
    rod = Rod(straight(0.6, start=(-0.4, 0.0)), RodParameters(bending_stiffness_n_m2=1e-6))
    assert grasp(rod, "left", "pinch", (0.2, 0.0, 0.0033))
    carry(rod, {"left": (0.28, 0.0, 0.0033)}, speed_m_s=0.1)
    weight_n = 9.81 * (0.6 * rod.parameters.density_kg_m + 2 * rod.parameters.connector_mass_kg)
    assert rod.force_n("left")[0] == pytest.approx(
        rod.parameters.friction_table * weight_n, rel=0.1
    )


def test_equal_calls_give_bit_equal_results():
    def run():
        rod = Rod(straight(0.6, start=(-0.3, 0.0), along=(0.8, 0.6)))
        grasp(rod, "left", "cage", (0.0, 0.225, 0.0033))
        carry(rod, {"left": (0.1, 0.0, 0.1)})
        rod.release_hand("left")
        rod.advance(0.2)
        return rod.positions_m.tobytes() + rod.velocities_m_s.tobytes()

    assert run() == run()


def test_beyond_the_edge_there_is_no_support():
    rod = Rod(straight(0.4, start=(0.25, 0.0)))
    rod.advance(0.6)
    assert rod.positions_m[-1, 2] < -0.03
    assert rod.positions_m[0, 2] == pytest.approx(rod.parameters.radius_m, abs=1e-3)


def test_cable_that_hangs_over_an_edge_is_drawn_in_by_little_more_than_its_weight():
    hanging = np.array([[0.5033, 0.0, 0.003 - 0.01 * k] for k in range(1, 25)])
    lying = np.column_stack([np.linspace(0.0, 0.5, 51), np.zeros(51), np.full(51, 0.0033)])
    rod = Rod(np.vstack([lying, hanging]))
    rod.advance(0.1)
    assert grasp(rod, "left", "pinch", (0.3, 0.0, 0.0033))
    carry(rod, {"left": (0.3, 0.0, 0.03)})
    carry(rod, {"left": (0.0, 0.0, 0.03)})
    weight_n = 0.24 * rod.parameters.density_kg_m * rod.parameters.gravity_m_s2
    assert rod.tension_n("left") < 4.0 * weight_n
    assert rod.positions_m[:, 2].min() > -0.01


def test_resting_cable_wakes_when_something_comes_near():
    rod = Rod(straight(0.3))
    far, near = np.array([[0.15, 0.1, 0.01]]), np.array([[0.15, 0.0, 0.01]])
    up = np.array([0.0, 0.0, 0.05])
    rod.set_capsules(far, far + up, np.array([0.01]))
    rod.advance(0.3)
    assert rod.at_rest
    rod.set_capsules(near, near + up, np.array([0.01]))
    rod.advance(0.2)
    assert not rod.at_rest
    assert rod.positions_m[:, 1].min() < -0.005


@pytest.mark.parametrize("nodes", [np.zeros((3, 3)), np.zeros((9, 2)), np.full((9, 3), np.nan)])
def test_nodes_that_make_no_cable_are_refused(nodes):
    with pytest.raises(InputError, match="Rod: nodes; got"):
        Rod(nodes)


def test_a_hand_that_was_never_moved_is_named():
    rod = Rod(straight(0.3))
    rod.move_hand("left", tool(0.0, 0.0, 0.3))
    with pytest.raises(InputError, match=r"got 'rihgt'; expected one of: left"):
        rod.release_hand("rihgt")
