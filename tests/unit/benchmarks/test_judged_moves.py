"""The physics as judge of predicted moves: loops are dilated, and ends come out of them."""

import numpy as np
import pytest

from benchmarks.moves import CONFIG, PX_PER_M, TABLE, judge, seen
from perception.cable.planning import Agreement, MoveKind, plan_moves
from simulation.cable.configurations import settle
from simulation.cable.heights import lift_over
from simulation.cable.knots import TEMPLATES
from simulation.cable.rod import Rod
from simulation.cable.truth import centre_line_crossings


def _tied(name, diameter_m=0.2, tail_m=0.2):
    """Return a knot with straight tails at rest."""
    template, spacing_m = TEMPLATES[name], TABLE.node_spacing_m
    curve = template.curve_m(diameter_m, spacing_m)
    tails = []
    for end, inner in ((curve[0], curve[3]), (curve[-1], curve[-4])):
        unit = (end - inner) / np.linalg.norm(end - inner)
        tails.append(end + np.arange(spacing_m, tail_m, spacing_m)[:, None] * unit)
    line = np.vstack([tails[0][::-1], curve, tails[1]])
    flat = np.column_stack([line, np.full(len(line), TABLE.radius_m)])
    crossings = centre_line_crossings(flat)
    lift_m = 2.2 * TABLE.radius_m
    return settle(lift_over(flat, crossings, template.first_over(crossings), lift_m), TABLE)


@pytest.mark.parametrize("name", ["overhand", "figure_8"])
def test_what_is_predicted_of_a_dilation_comes_true(name):
    nodes_m = _tied(name)
    plan = plan_moves(seen(nodes_m), CONFIG)
    assert plan.steps[0].kind is MoveKind.DILATE
    outcome = judge(Rod(nodes_m, TABLE), plan)
    assert outcome.held
    assert outcome.fewer
    assert outcome.agreement in (Agreement.SAME, Agreement.BUT_FOR_TWISTS)


def test_a_cable_is_seen_as_large_as_a_camera_shows_it():
    nodes_m = np.column_stack([np.linspace(0.0, 1.0, 11), np.zeros(11), np.zeros(11)])
    assert np.ptp(seen(nodes_m).points[:, 0]) == pytest.approx(PX_PER_M)
