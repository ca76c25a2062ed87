from dataclasses import replace

import numpy as np
import pytest
from cell_fakes import ArrivingArms, finished, frame, overhand

from executive.core.work import InlineWorker
from perception.cable.grasp_sites import cage_sites, pinch_sites
from perception.cable.polyline import arc_lengths
from skills.cable.dilate_knot import SLACK_M, DilateKnot, _Grip, apart, unlike
from skills.cable.knot_sites import HANDS_APART_M, REACH_X_M, given_pairs, ranked_pairs
from skills.cable.laying_out import Pull


def inputs(**more):
    trace, crossings, knot = overhand()
    return {"frame": frame(), "trace": trace, "crossings": crossings, "knots": (knot,), **more}


def test_one_hand_cages_the_other_pinches_and_both_let_go_at_the_end():
    arms = ArrivingArms()
    outcome, _ = finished(DilateKnot(arms, InlineWorker()), inputs())
    grips = [entry[1:] for entry in arms.log if entry[0] == "grip"]
    assert outcome.status == "SUCCESS"
    assert sorted(grip for _, grip in grips[:2]) == ["cage", "pinch"]
    assert sorted(grips[2:]) == [("left", "open"), ("right", "open")]


def test_hands_end_farther_apart_along_the_long_side_by_what_was_asked():
    arms = ArrivingArms()
    finished(DilateKnot(arms, InlineWorker()), inputs(travel_m=0.2))
    moves = [entry[1] for entry in arms.log if entry[0] == "move"]
    gaps = [np.linalg.norm(np.subtract(tools["left"], tools["right"])) for tools in moves]
    assert gaps[3] - gaps[2] == pytest.approx(0.2, abs=0.002)  # hover, down, lift, then apart
    assert moves[3]["left"][1] == pytest.approx(moves[3]["right"][1])


def test_a_blocked_way_apart_is_tried_shorter():
    arms = ArrivingArms()
    skill = DilateKnot(arms, InlineWorker())
    skill.start(inputs())
    while not any(entry[0] == "grip" for entry in arms.log):
        skill.step()
    while len([entry for entry in arms.log if entry[0] == "move"]) < 3:
        skill.step()
    arms.lines_blocked = 2
    while (outcome := skill.step()).status == "RUNNING":
        pass
    assert outcome.status == "SUCCESS"


def test_the_caging_hand_opens_before_a_plug_and_the_other_draws_the_end_out():
    arms = ArrivingArms()
    trace = overhand()[0]
    near = replace(trace, points_px=trace.points_px[-12:])
    skill = DilateKnot(arms, InlineWorker())
    pull = Pull(frame().camera.on_plane(near.points_px)[:, :2], 0.0, 0.0)
    length_m = float(arc_lengths(pull.line_m)[-1])
    pull = replace(pull, cage_m=0.2 * length_m, pinch_m=0.6 * length_m)
    ends = np.array([-0.3, 0.0]), np.array([0.3, 0.0])
    grip = _Grip(("left", "right"), (), pull, (ends,))
    arms.tools = {"left": np.array([-0.05, 0.0, 0.01]), "right": np.array([0.05, 0.0, 0.01])}
    for _ in skill._pull_apart(grip, 0.0):
        pass
    opened = arms.log.index(("grip", "left", "open"))
    moves = [entry[1] for entry in arms.log[opened:] if entry[0] == "move"]
    assert moves[0]["right"][:2] == pytest.approx(ends[1], abs=SLACK_M + 2e-3)
    assert all(move["left"] == moves[0]["left"] for move in moves)
    assert moves[-1]["right"][2] < moves[0]["right"][2]


def test_hands_come_nearer_to_each_other_before_they_open():
    arms = ArrivingArms()
    finished(DilateKnot(arms, InlineWorker()), inputs(travel_m=0.2))
    opens = arms.log.index(("grip", "left", "open"))
    moves = [entry[1] for entry in arms.log[:opens] if entry[0] == "move"]
    gaps = [np.linalg.norm(np.subtract(tools["left"], tools["right"])) for tools in moves]
    assert max(gaps) - gaps[-1] == pytest.approx(2 * SLACK_M, abs=1e-4)


def test_closing_on_nothing_is_a_miss_and_lets_go():
    arms = ArrivingArms(held=False)
    outcome, _ = finished(DilateKnot(arms, InlineWorker()), inputs())
    assert outcome.reason.code == "grasp.missed"
    assert arms.log[-2][0] == "grip" or arms.log[-1][0] == "move"


def test_no_knot_is_a_reason_of_its_own_and_moves_nothing():
    arms = ArrivingArms()
    outcome, _ = finished(DilateKnot(arms, InlineWorker()), inputs() | {"knots": ()})
    assert (outcome.reason.code, arms.log) == ("knot.none", [])


def test_halting_stops_the_arms():
    arms = ArrivingArms()
    skill = DilateKnot(arms, InlineWorker())
    skill.start(inputs())
    skill.step()
    skill.halt()
    assert arms.log[-1] == ("stop",)


def test_pairs_leave_room_for_two_hands_and_prefer_a_pinch_inside_the_knot():
    trace, crossings, knot = overhand()
    cages, pinches = cage_sites(trace, crossings, knot), pinch_sites(trace, crossings, knot)
    pairs = ranked_pairs(cages, pinches, knot, frame())
    gaps_m = [np.linalg.norm(cage.point_px - pinch.point_px) / 1e3 for cage, pinch in pairs]
    assert min(gaps_m) >= HANDS_APART_M
    assert pairs[0][1].arc <= knot.interval[1] + 0.02


@pytest.mark.parametrize("middle_x_m", [-0.3, 0.0, 0.25])
def test_hands_never_leave_the_reach_when_they_move_apart(middle_x_m):
    tips = {
        arm: np.array([middle_x_m + s, 0.0, 0.04]) for arm, s in (("left", -0.06), ("right", 0.06))
    }
    ends = {arm: tips[arm] + way for arm, way in apart(tips, 0.6).items()}
    assert all(abs(end[0]) <= REACH_X_M + 1e-9 for end in ends.values())
    assert np.linalg.norm(ends["left"] - ends["right"]) == pytest.approx(0.6)


def test_given_places_come_first_and_a_walk_makes_room_for_two_hands():
    trace, _, knot = overhand()
    at_crossing = trace.points_px[int(0.7 * len(trace.points_px))]
    knot = replace(knot, cage_px=trace.points_px[40], pinch_px=at_crossing)
    pairs = given_pairs(trace, knot, frame())
    assert np.allclose(pairs[0][0].point_px, knot.cage_px)
    assert np.allclose(pairs[0][1].point_px, knot.pinch_px)
    near = replace(knot, pinch_px=trace.points_px[42])
    walked = given_pairs(trace, near, frame())[0]
    gap_m = np.linalg.norm(walked[0].point_px - walked[1].point_px) / 1e3
    assert HANDS_APART_M <= gap_m < HANDS_APART_M + 0.05


def test_places_that_are_much_the_same_are_tried_once():
    here, beside, far = (
        tuple(np.array(end) for end in ends)
        for ends in (
            ((0.0, 0.0), (0.4, 0.0)),
            ((0.02, 0.0), (0.42, 0.0)),
            ((0.0, 0.15), (0.4, 0.15)),
        )
    )
    kept = unlike([here, beside, far])
    assert [ends is one for ends, one in zip(kept, (here, far), strict=True)] == [True, True]
