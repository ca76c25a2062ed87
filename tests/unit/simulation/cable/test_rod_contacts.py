"""Strands, fingers and the table keep out of each other; friction follows Coulomb."""

from itertools import pairwise

import numpy as np
import pytest
from rods import carry, floating, grasp, straight

from perception.cable.topology import Knottedness, classify_curve
from simulation.cable.configurations import settle
from simulation.cable.heights import lift_over
from simulation.cable.knots import TEMPLATES
from simulation.cable.parameters import RodParameters
from simulation.cable.rod import Rod
from simulation.cable.truth import centre_line_crossings

RADIUS_M = RodParameters().radius_m


def tied(knot, diameter_m=0.1, tail_m=0.25):
    """Return a short cable at rest with a knot in its middle, under and over by turns."""
    curve = TEMPLATES[knot].curve_m(diameter_m, 0.01)
    steps = np.arange(1, round(tail_m / 0.01) + 1)[:, None]
    line = np.vstack(
        [(curve[0] + steps * (curve[0] - curve[1]))[::-1], curve,
         curve[-1] + steps * (curve[-1] - curve[-2])]
    )  # fmt: skip
    flat = np.column_stack([line, np.full(len(line), RADIUS_M)])
    crossings = centre_line_crossings(flat)
    first_over = TEMPLATES[knot].first_over(crossings)
    return settle(lift_over(flat, crossings, first_over, 2.2 * RADIUS_M), RodParameters())


@pytest.mark.parametrize("knot", ["overhand", "figure_8"])
def test_a_knot_that_is_pulled_tight_stays_that_knot(knot):
    nodes_m = tied(knot)
    before = classify_curve(nodes_m)
    rod = Rod(nodes_m)
    ends = {"left": nodes_m[8], "right": nodes_m[-9]}
    for hand, point_m in ends.items():
        assert grasp(rod, hand, "pinch", point_m)
    apart = ends["right"][:2] - ends["left"][:2]
    apart /= np.linalg.norm(apart)
    peak_n = 0.0
    for pull_m in np.arange(0.01, 0.4, 0.01):
        targets = {
            "left": [*(ends["left"][:2] - pull_m * apart), 0.05],
            "right": [*(ends["right"][:2] + pull_m * apart), 0.05],
        }
        carry(rod, targets, speed_m_s=0.5)
        peak_n = max(peak_n, rod.tensions_n.max())
    assert peak_n > 10.0
    after = classify_curve(rod.positions_m)
    assert before.state is after.state is Knottedness.KNOTTED
    assert after.reduced_crossings == before.reduced_crossings


def test_a_strand_swept_at_full_speed_does_not_pass_through_another():
    lower, upper = straight(0.4, start=(-0.2, 0.0)), straight(0.4, along=(0.0, 1.0))
    bridge_m = np.array([[0.25, 0.0, RADIUS_M], [0.25, -0.3, 0.03], [0.0, -0.3, 0.03]])
    upper += [0.0, -0.2, 0.03]
    nodes_m = np.vstack([lower, _filled(lower[-1], bridge_m, upper[0]), upper])
    rod = Rod(nodes_m)
    grasp(rod, "left", "pinch", nodes_m[0])
    grasp(rod, "right", "pinch", nodes_m[-1], opening="x")
    start = rod.hands["right"].pose[:3, 3].copy()
    carry(rod, {"right": start - np.array([0.0, 0.1, 0.03])}, speed_m_s=1.0, opening="x")
    carry(rod, {"right": start - np.array([0.4, 0.1, 0.03])}, speed_m_s=1.0, opening="x")
    assert closest_strands_m(rod.positions_m) > 0.7 * 2.0 * RADIUS_M


def _filled(first, corners_m, last):
    points = np.vstack([first, corners_m, last])
    pieces = []
    for a, b in pairwise(points):
        count = max(1, round(np.linalg.norm(b - a) / 0.01))
        pieces.append(a + (b - a) * (np.arange(1, count + 1) / count)[:, None])
    return np.vstack(pieces)[:-1]


def closest_strands_m(nodes_m, apart=6):
    """Return the least distance of points of the cable that are far apart along it."""
    fine = np.stack([np.interp(np.arange(0, len(nodes_m) - 1, 0.1), np.arange(len(nodes_m)), axis)
                     for axis in nodes_m.T], axis=1)  # fmt: skip
    i, j = np.triu_indices(len(fine), 10 * apart)
    return float(np.linalg.norm(fine[i] - fine[j], axis=1).min())


def test_a_finger_pushes_the_cable_ahead_of_it():
    rod = Rod(straight(0.6, start=(-0.3, 0.0)))
    low, high = np.array([[0.0, -0.05, 0.005]]), np.array([[0.0, -0.05, 0.05]])
    rod.set_capsules(low, high, np.array([0.005]))
    for step in range(100):
        shift = np.array([0.0, 0.0015 * (step + 1), 0.0])
        rod.set_capsules(low + shift, high + shift, np.array([0.005]))
        rod.advance(0.0015)
    finger_y_m = low[0, 1] + 0.15
    middle_m = rod.positions_m[np.abs(rod.positions_m[:, 0]) < 0.01]
    assert middle_m[:, 1].min() > finger_y_m + 0.6 * (0.005 + RADIUS_M)


@pytest.mark.parametrize("friction", [0.0, 0.2, 0.4])
def test_friction_round_a_cylinder_is_the_capstan_s(friction):
    """T2 / T1 = exp(mu angle): Euler and Eytelwein."""
    radius_m, height_m = 0.03, 0.3
    reach_m = radius_m + 1.15 * RADIUS_M
    angles = np.linspace(np.pi, 0.0, round(np.pi * reach_m / 0.01) + 1)
    over = np.column_stack([reach_m * np.cos(angles), reach_m * np.sin(angles)])
    drop = 0.01 * np.arange(20, 0, -1)
    xz = np.vstack([np.column_stack([np.full(20, -reach_m), -drop]), over,
                    np.column_stack([np.full(20, reach_m), -drop[::-1]])])  # fmt: skip
    nodes_m = np.column_stack([xz[:, 0], np.zeros(len(xz)), height_m + xz[:, 1]])
    rod = Rod(
        nodes_m,
        floating(
            friction_obstacles=friction,
            pinch_force_n=2.0,
            bending_stiffness_n_m2=1e-6,
            air_damping_1_s=10.0,
        ),
    )
    axis = np.array([[0.0, -0.1, height_m]]), np.array([[0.0, 0.1, height_m]])
    rod.set_capsules(*axis, np.array([radius_m]))
    grasp(rod, "left", "pinch", nodes_m[10])
    grasp(rod, "right", "cage", nodes_m[-2])
    carry(rod, {"right": nodes_m[-2] - [0.0, 0.0, 0.02]}, speed_m_s=0.03)
    held, pulled = rod.tensions_n[12:18].mean(), rod.tensions_n[-12:-6].mean()
    assert held > 1.0
    assert np.log(pulled / held) / np.pi == pytest.approx(friction, abs=0.03)
