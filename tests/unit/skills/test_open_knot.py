from dataclasses import replace

import numpy as np
from cell_fakes import ArrivingArms, finished, frame, overhand

from executive.core.work import InlineWorker
from skills.cable.open_knot import OpenKnot


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
