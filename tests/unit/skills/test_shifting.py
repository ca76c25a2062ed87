from dataclasses import replace

import numpy as np
import pytest
from cell_fakes import ArrivingArms, finished, frame, overhand

from executive.core.work import InlineWorker
from perception.cable.types import Endpoint, TraceEnd
from skills.cable.bring_knot import BringKnot
from skills.cable.perturb_doubt import PerturbDoubt
from skills.cable.perturb_endpoint import HALF_SQUARE_APART_M, PerturbEndpoint
from skills.cable.pull_in import PullIn
from skills.cable.pulling import towards_middle
from skills.cable.shifting import HALF_SQUARE_M, Hold, room_map, roomiest_steps


class BlindVision:
    """Sees one vertical strand at column 600 and nothing else."""

    def cable_pixels(self, image):
        cable = np.zeros(image.shape, dtype=bool)
        cable[:, 596:604] = True
        return cable


def end_at(x_px: float) -> Endpoint:
    return Endpoint(np.array([x_px, 375.0]), np.array([-1.0, 0.0]), 0.9)


def test_an_end_is_shifted_away_from_the_strand_beside_it_and_within_the_square():
    arms = ArrivingArms()
    skill = PerturbEndpoint(arms, InlineWorker(), BlindVision(), np.random.default_rng(3))
    outcome, _ = finished(skill, {"frame": frame(), "endpoints": (end_at(560.0),)})
    moves = [entry[1]["right"] for entry in arms.log if entry[0] == "move"]
    step_m = np.subtract(moves[3], moves[2])
    assert outcome.status == "SUCCESS"
    assert np.abs(step_m[:2]).max() <= HALF_SQUARE_M + 1e-6
    assert step_m[0] < 0.0  # the strand is on the right


def test_an_end_out_of_reach_is_said_to_be():
    skill = PerturbEndpoint(ArrivingArms(), InlineWorker(), BlindVision(), np.random.default_rng(3))
    outcome, _ = finished(skill, {"frame": frame(), "endpoints": (end_at(990.0),)})
    assert outcome.reason.code == "grasp.unreachable"


def test_an_end_near_the_rim_of_the_table_is_not_shifted_towards_it():
    cable = np.zeros((751, 1001), dtype=bool)
    end_px = np.array([[70.0, 375.0]])
    hold = Hold(end_px[0] + [25.0, 0.0], np.array([1.0, 0.0]), end_px)
    step_m = roomiest_steps(frame(), end_px, room_map(cable, hold), np.random.default_rng(0))[0]
    assert step_m[0] > 0.0


def test_a_blocked_shift_is_tried_less_far():
    arms = ArrivingArms()
    skill = PerturbEndpoint(arms, InlineWorker(), BlindVision(), np.random.default_rng(3))
    skill.start({"frame": frame(), "endpoints": (end_at(560.0),)})
    while len([entry for entry in arms.log if entry[0] == "move"]) < 3:
        skill.step()
    arms.lines_blocked = 2
    while (outcome := skill.step()).status == "RUNNING":
        pass
    assert outcome.status == "SUCCESS"


def test_steps_with_more_room_come_first():
    cable = np.zeros((751, 1001), dtype=bool)
    cable[:, 600] = True
    hold = Hold(np.array([500.0, 375.0]), np.array([1.0, 0.0]), np.array([[580.0, 375.0]]))
    room = room_map(cable, hold)
    steps = roomiest_steps(frame(), hold.leading_px, room, np.random.default_rng(0))
    rooms = [room(hold.leading_px[0] + 1e3 * step[:2] * [1, -1]) for step in steps]
    assert rooms == sorted(rooms, reverse=True)


def test_cable_is_pulled_from_the_end_of_its_trace_towards_the_middle():
    arms = ArrivingArms()
    trace, _, _ = overhand()
    outcome, _ = finished(PullIn(arms, InlineWorker()), {"frame": frame(), "trace": trace})
    moves = [entry[1]["right"] for entry in arms.log if entry[0] == "move"]
    assert outcome.status == "SUCCESS"
    assert np.linalg.norm(moves[3][:2]) < np.linalg.norm(moves[2][:2])


def test_pulling_never_goes_beyond_the_middle():
    assert np.allclose(towards_middle(np.array([0.1, 0.0, 0.01]), 0.5), [-0.1, 0.0, 0.0])
    assert np.allclose(towards_middle(np.zeros(3), 0.5), 0.0)


def test_a_connector_is_moved_clear_of_the_strand_that_crosses_it():
    """The end points to the right, and a strand runs from top to bottom across it."""
    end = np.array([540.0, 375.0])
    connector = end + np.arange(0.0, 40.0, 2.0)[:, None] * [1.0, 0.0]
    hold = Hold(np.array([515.0, 375.0]), np.array([-1.0, 0.0]), connector)
    cable = np.zeros((773, 1032), bool)
    cable[370:380, 300:580] = True
    cable[200:600, 558:564] = True
    step_m = roomiest_steps(frame(), connector, room_map(cable, hold), np.random.default_rng(0))[0]
    moved = frame().camera.project(frame().camera.on_plane(connector) + step_m)
    assert np.abs(moved[:, 0] - 561.0).min() > 20.0


def test_a_knot_is_brought_to_the_middle_once():
    trace, _, knot = overhand()
    inputs = {"frame": frame(), "trace": trace, "knots": (knot,)}
    outcome, _ = finished(BringKnot(ArrivingArms(), InlineWorker()), inputs)
    assert outcome.reason.code == "knot.near"
    aside = replace(trace, points_px=trace.points_px + np.array([220.0, 0.0]))
    arms = ArrivingArms()
    outcome, _ = finished(BringKnot(arms, InlineWorker()), inputs | {"trace": aside})
    assert outcome.status == "SUCCESS"


class MissesOnce(ArrivingArms):
    """Arms whose fingers close on nothing the first time."""

    closed = 0

    def holds(self, arm):
        self.closed += 1
        return self.closed > 1


def test_a_miss_is_followed_by_another_place_on_the_cable():
    arms, (trace, _, _) = MissesOnce(), overhand()
    outcome, _ = finished(PullIn(arms, InlineWorker()), {"frame": frame(), "trace": trace})
    downs = [entry[1]["right"] for entry in arms.log if entry[0] == "move"]
    assert outcome.status == "SUCCESS"
    assert arms.closed == 2
    assert downs[1] != downs[4]  # hover, down, up again, hover, down


def test_an_arm_goes_down_only_where_it_can_go_on():
    """Reaching the place is not enough: the whole way is asked for before a hand goes down."""

    class ShortArms(ArrivingArms):
        def reachable(self, arm, goal):
            end_m = goal.position_m + sum(goal.onward_m)
            return super().reachable(arm, goal) and abs(end_m[1]) < 0.06

    arms, (trace, _, _) = ShortArms(), overhand()
    outcome, _ = finished(PullIn(arms, InlineWorker()), {"frame": frame(), "trace": trace})
    moves = [entry[1]["right"] for entry in arms.log if entry[0] == "move"]
    assert outcome.status == "SUCCESS"
    assert abs(moves[3][1]) < 0.06


@pytest.mark.parametrize("end", list(TraceEnd))
def test_a_trace_too_short_to_hold_is_said_to_be_out_of_reach(end):
    trace, _, _ = overhand()
    stub = replace(trace, points_px=trace.points_px[:2], end=end)
    skill = PerturbDoubt(ArrivingArms(), InlineWorker(), BlindVision(), np.random.default_rng(3))
    outcome, _ = finished(skill, {"frame": frame(), "trace": stub, "crossings": ()})
    assert outcome.reason.code == "grasp.unreachable"


def test_of_ends_side_by_side_one_is_taken_far_away_and_ends_apart_are_left_alone():
    apart = {"frame": frame(), "endpoints": (end_at(300.0), end_at(600.0)), "only_covered": True}
    arms = ArrivingArms()
    skill = PerturbEndpoint(arms, InlineWorker(), BlindVision(), np.random.default_rng(3))
    outcome, _ = finished(skill, apart)
    assert (outcome.reason.code, arms.log) == ("ends.clear", [])
    outcome, _ = finished(skill, apart | {"endpoints": (end_at(500.0), end_at(530.0))})
    moves = [entry[1] for entry in arms.log if entry[0] == "move"]
    ways_m = [np.abs(np.subtract(moves[3][arm][:2], moves[2][arm][:2])).max() for arm in moves[3]]
    assert outcome.status == "SUCCESS"
    assert HALF_SQUARE_M < max(ways_m) <= HALF_SQUARE_APART_M
