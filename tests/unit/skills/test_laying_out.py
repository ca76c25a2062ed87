"""Predicted pulls: cable is neither lost nor stretched, hands stay in reach, heaps are avoided."""

from dataclasses import replace

import numpy as np
import pytest
from cell_fakes import ArrivingArms, finished, frame, overhand

from executive.core.work import InlineWorker
from perception.cable.polyline import arc_lengths
from skills.cable.dilate_knot import DilateKnot
from skills.cable.knot_sites import REACH_X_M, REACH_Y_M, deeper_pairs
from skills.cable.laying_out import (
    FINGERS_M,
    PLUG_M,
    Pull,
    best_places,
    crossings_of,
    followed,
    places,
    tangle_cost,
)

LINE = np.column_stack([np.linspace(-0.4, 0.4, 81), 0.1 * np.sin(np.linspace(0.0, 9.0, 81))])
LENGTH_M = float(arc_lengths(LINE)[-1])


@pytest.mark.parametrize("to_m", [(0.0, 0.3), (-0.7, 0.0), (-0.38, 0.01)])
def test_what_follows_keeps_its_length_and_is_never_longer_apart(to_m):
    line = followed(LINE, np.array(to_m))
    before, after = (np.linalg.norm(np.diff(each, axis=0), axis=1) for each in (LINE, line))
    assert np.allclose(line[0], to_m)
    assert (after <= before + 1e-9).all()


def test_a_line_that_is_not_drawn_tight_stays_where_it_is_farther_on():
    line = followed(LINE, LINE[0] + (0.02, 0.02))
    assert np.allclose(line[10:], LINE[10:])


def test_hands_that_go_farther_apart_than_there_is_cable_draw_it_out_of_the_tail():
    pull = Pull(LINE, 0.4, 0.6)
    ends = np.array([-0.25, 0.1]), np.array([0.25, 0.1])
    assert pull.slides(ends)
    assert pull.drawn_m(ends) == pytest.approx(0.5 - 0.2)
    line = pull.predicted(ends)
    assert float(arc_lengths(line)[-1]) == pytest.approx(LENGTH_M, rel=0.05)


def test_a_caging_hand_opens_before_the_plug_comes_to_it_and_only_then():
    long, short = Pull(LINE, 0.4, 0.6), Pull(LINE, 0.1, 0.3)
    ends = np.array([-0.25, 0.1]), np.array([0.25, 0.1])
    assert long.lets_go(ends) == 1.0
    share = short.lets_go(ends)
    at_m = [
        (1.0 - share) * np.array([np.interp(arc, arc_lengths(LINE), x) for x in LINE.T])
        + share * end
        for arc, end in zip((0.1, 0.3), ends, strict=True)
    ]
    assert 0.0 < share < 1.0
    assert np.linalg.norm(at_m[1] - at_m[0]) == pytest.approx(0.3 - PLUG_M, abs=0.02)
    assert [hand.lets_go for hand in short.hands(ends)] == [share, 1.0]


def test_a_caging_hand_opens_sooner_where_the_other_may_hold_an_earlier_strand_too():
    """The cable comes back beside itself: fingers there close on 0.3 m and on 0.9 m of it."""
    out_m, back_m = np.linspace((0.0, 0.0), (0.6, 0.0), 61), np.linspace((0.6, 0.01), (0, 0.01), 61)
    pull = Pull(np.vstack([out_m, back_m]), 0.1, 0.91)
    ends = np.array([-0.35, 0.0]), np.array([0.35, 0.0])
    share = pull.lets_go(ends)
    apart_m = 0.2 + share * (0.7 - 0.2)
    assert apart_m == pytest.approx(0.3 - PLUG_M, abs=FINGERS_M + 0.02)


def test_a_tail_that_was_let_go_lies_straight_behind_the_other_hand():
    line = Pull(LINE, 0.1, 0.3).predicted((np.array([-0.35, 0.1]), np.array([0.35, 0.1])))
    assert float(arc_lengths(line)[-1]) == pytest.approx(LENGTH_M, rel=0.05)
    assert line[0] == pytest.approx([0.35 - 0.3, 0.1])


def test_where_a_long_loop_lies_between_the_hands_the_tail_is_taken_along():
    turn = np.linspace(0.2, 2.0 * np.pi - 0.2, 60)
    loop = 0.15 * np.column_stack([-np.cos(turn), np.sin(turn)])
    line = np.vstack([loop[0] + np.arange(40, 0, -1)[:, None] * (-0.01, 0.0), loop])
    pull = Pull(line, 0.4, float(arc_lengths(line)[-1]) - 0.05)
    ends = np.array([-0.3, -0.1]), np.array([0.2, -0.1])
    assert not pull.slides(ends)
    assert 0.25 < pull.drawn_m(ends) <= 0.4
    assert pull.drawn_m((line[40], line[-1])) < 0.02


def test_a_line_that_crosses_itself_is_worse_and_so_is_one_that_lies_beside_itself():
    turn = np.linspace(0.0, 2.0 * np.pi, 40)
    circle = 0.15 * np.column_stack([np.cos(turn), np.sin(turn)])
    crossed = np.vstack([circle, circle[0] + np.arange(1, 12)[:, None] * (-0.03, 0.001)])
    beside = np.vstack([LINE, LINE[::-1] + np.array([0.0, 0.01])])
    assert tangle_cost(LINE) == 0.0
    assert tangle_cost(crossed) >= 1.0
    assert tangle_cost(beside) > 1.0
    assert tangle_cost(LINE + np.array([0.0, 1.0])) > tangle_cost(LINE + np.array([0.5, 0.0])) > 2.0


@pytest.mark.parametrize("left_holds_cage", [False, True])
def test_places_are_in_reach_and_the_arms_do_not_cross(left_holds_cage):
    for cage_m, pinch_m in places(left_holds_cage):
        left, right = (cage_m, pinch_m) if left_holds_cage else (pinch_m, cage_m)
        assert left[0] < right[0]
        for place in (left, right):
            assert abs(place[0]) <= REACH_X_M + 1e-9
            assert REACH_Y_M[0] <= place[1] <= REACH_Y_M[1]


def test_the_best_places_are_better_than_any_others():
    pull = Pull(LINE, 0.4, 0.6)
    best = best_places(pull, True, 3)
    costs = [pull.cost(ends) for ends in best]
    assert costs == sorted(costs)
    assert costs[0] == min(pull.cost(ends) for ends in places(True))
    assert best_places(Pull(LINE, 0.6, 0.4), True, 3) == []


@pytest.mark.parametrize("cage_m", [0.15, 0.3, 0.45])
def test_no_place_is_chosen_where_more_crossings_should_be_left(cage_m):
    turn = np.linspace(0.0, 3.5 * np.pi, 120)
    coil = (0.06 + 0.01 * turn)[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
    pull = Pull(coil, cage_m, cage_m + 0.3)
    for ends in best_places(pull, True, 8):
        assert crossings_of(pull.predicted(ends)) <= crossings_of(coil)


def test_a_pull_that_could_only_tangle_more_is_refused(monkeypatch):
    arms = ArrivingArms()
    trace, crossings, knot = overhand()
    pairs = deeper_pairs(trace, crossings, knot, frame())
    monkeypatch.setattr("skills.cable.dilate_knot.best_places", lambda *_: [])
    monkeypatch.setattr("skills.cable.dilate_knot.searched_pairs", lambda *_: pairs)
    inputs = {"frame": frame(), "trace": trace, "crossings": crossings, "knots": (knot,)}
    outcome, _ = finished(DilateKnot(arms, InlineWorker()), inputs | {"planned": True})
    assert (outcome.reason.code, arms.log) == ("pull.refused", [])


def test_a_pull_says_how_many_crossings_it_should_leave():
    trace, crossings, knot = overhand()
    inputs = {"frame": frame(), "trace": trace, "crossings": crossings, "knots": (knot,)}
    outcome, _ = finished(DilateKnot(ArrivingArms(), InlineWorker()), inputs | {"planned": True})
    on_table = frame().camera.on_plane(trace.points_px)[:, :2]
    assert 0 <= outcome.outputs["predicted"] <= crossings_of(on_table)


class LikesRoom:
    """Imagines a straight cable where the hands go to one pair of places, and a heap elsewhere."""

    def __init__(self):
        self.liked, self.asked = None, []

    def after(self, line_m, over, hands):
        self.asked.append(np.vstack([hand.to_m for hand in hands]))
        if self.liked is None:
            self.liked = self.asked[-1] if len(self.asked) == 3 else None
        good = self.liked is self.asked[-1]
        turn = np.linspace(0.0, 1.0 if good else 25.0, 200)
        circle = 0.1 * np.column_stack([np.cos(turn), np.sin(turn)])
        return np.column_stack([circle, np.linspace(0.0, 0.1, 200)])


def test_of_pulls_that_can_be_imagined_that_with_the_best_outcome_is_made():
    arms, foresight = ArrivingArms(), LikesRoom()
    trace, crossings, knot = overhand()
    inputs = {"frame": frame(), "trace": trace, "crossings": crossings, "knots": (knot,)}
    skill = DilateKnot(arms, InlineWorker(), foresight)
    outcome, _ = finished(skill, inputs | {"planned": True})
    moves = [entry[1] for entry in arms.log if entry[0] == "move"]
    ends = np.array([moves[3][arm][:2] for arm in ("left", "right")])
    assert outcome.status == "SUCCESS"
    assert len(foresight.asked) > 3
    gaps_m = [np.abs(order - foresight.liked).max() for order in (ends, ends[::-1])]
    assert min(gaps_m) < 2e-3


def test_a_planned_dilation_ends_where_the_cable_should_lie_best():
    arms = ArrivingArms()
    trace, crossings, knot = overhand()
    inputs = {"frame": frame(), "trace": trace, "crossings": crossings, "knots": (knot,)}
    outcome, _ = finished(DilateKnot(arms, InlineWorker()), inputs | {"planned": True})
    moves = [entry[1] for entry in arms.log if entry[0] == "move"]
    ends = [np.array(moves[3][arm][:2]) for arm in ("left", "right")]
    assert outcome.status == "SUCCESS"
    assert any(
        np.allclose(ends, pair, atol=2e-3) or np.allclose(ends[::-1], pair, atol=2e-3)
        for pair in places(True)
    )


def test_deeper_pairs_begin_in_the_knot_and_those_behind_it_come_last():
    trace, crossings, knot = overhand()
    pairs = deeper_pairs(trace, crossings, knot, frame())
    low, high = knot.interval
    behind = [pinch.arc > high for _, pinch in pairs]
    assert all(low < cage.arc < pinch.arc for cage, pinch in pairs)
    assert all(cage.arc < high for cage, _ in pairs)
    assert behind == sorted(behind)
    assert not behind[0]


def test_a_knot_without_room_inside_is_held_behind_it():
    trace, crossings, knot = overhand()
    arc = knot.interval[0]
    small = replace(knot, interval=(arc, arc + 0.05))
    pairs = deeper_pairs(trace, crossings, small, frame())
    assert pairs
    assert all(pinch.arc > small.interval[1] for _, pinch in pairs)
