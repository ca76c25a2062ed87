from dataclasses import replace

import numpy as np
from cell_fakes import ArrivingArms, finished, frame, overhand

from executive.core.work import InlineWorker
from skills.cable.open_knot import OpenKnot
from skills.cable.pull_in import free_first, off_edge_first
from skills.cable.pulling import ways_inwards


def opened(knot_of=lambda knot: (knot,), arms=None):
    trace, _, knot = overhand()
    arms = arms or ArrivingArms()
    inputs = {"frame": frame(), "trace": trace, "knots": knot_of(knot)}
    return finished(OpenKnot(arms, InlineWorker()), inputs)[0], arms


def test_a_bight_is_drawn_away_from_the_middle_of_the_knot():
    outcome, arms = opened()
    moves = [entry[1] for entry in arms.log if entry[0] == "move"]
    arm = next(entry[1] for entry in arms.log if entry[0] == "grip")
    held, drawn = (np.array(moves[k][arm][:2]) for k in (2, 3))
    assert outcome.status == "SUCCESS"
    assert np.linalg.norm(drawn) > np.linalg.norm(held) + 0.03  # the knot lies at the origin
    assert [entry[2] for entry in arms.log if entry[0] == "grip"] == ["pinch", "open"]


def test_a_knot_that_has_drawn_together_is_left_alone():
    outcome, arms = opened(lambda knot: (replace(knot, interval=(0.5, 0.51)),))
    assert (outcome.reason.code, arms.log) == ("knot.tight", [])


def test_without_a_knot_nothing_is_moved():
    outcome, arms = opened(lambda knot: ())
    assert (outcome.reason.code, arms.log) == ("knot.none", [])


def test_ways_past_other_cable_come_after_free_ones():
    """The hand is at the right end; the rest of the cable crosses its straight way in."""
    across = np.column_stack([np.full(50, 0.2), np.linspace(-0.2, 0.2, 50)])
    to_the_hand = np.column_stack([np.linspace(0.2, 0.4, 30)[1:], np.full(29, 0.2)])
    down = np.column_stack([np.full(20, 0.4), np.linspace(0.19, 0.0, 20)])
    line_m = np.vstack([across, to_the_hand, down])
    straight, aside = np.array([-0.25, 0.0, 0.0]), np.array([0.0, -0.25, 0.0])
    ordered = free_first([straight, aside], np.array([0.4, 0.0]), line_m)
    assert ordered[0] is aside
    assert free_first([straight, aside], np.array([0.4, 0.0]), line_m[-20:])[0] is straight


def test_a_knot_far_from_the_middle_is_drawn_towards_it():
    trace, _, knot = overhand()
    for aside_px in (-260.0, 260.0):
        arms = ArrivingArms()
        aside = replace(trace, points_px=trace.points_px + np.array([aside_px, 0.0]))
        finished(
            OpenKnot(arms, InlineWorker()), {"frame": frame(), "trace": aside, "knots": (knot,)}
        )
        moves = [entry[1] for entry in arms.log if entry[0] == "move"]
        arm = next(entry[1] for entry in arms.log if entry[0] == "grip")
        assert abs(moves[3][arm][0]) < abs(moves[2][arm][0])


def test_cable_over_an_edge_is_drawn_away_from_that_edge_and_not_along_it():
    hold_m = np.array([-0.36, -0.2, 0.0])
    front, left = (
        off_edge_first(ways_inwards(hold_m, 0.25), np.array(end_m))[0]
        for end_m in ((-0.36, -0.37), (-0.49, -0.2))
    )
    assert front[1] > 0.2
    assert left[0] > 0.2
