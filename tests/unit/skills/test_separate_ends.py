"""Both ends of a cable drawn apart: up first, along the table, down again."""

import numpy as np
import pytest
from cell_fakes import ArrivingArms, finished, frame

from executive.core.work import InlineWorker
from perception.cable.types import Endpoint
from skills.cable.knot_sites import REACH_X_M
from skills.cable.separate_ends import LIFT_M, SeparateEnds


def ends(*places_px):
    return tuple(Endpoint(np.array(place), np.array([0.0, 1.0]), 0.9) for place in places_px)


def separated(arms, *places_px):
    inputs = {"frame": frame(), "endpoints": ends(*places_px)}
    return finished(SeparateEnds(arms, InlineWorker()), inputs)[0]


def test_hands_lift_before_they_part_and_lay_down_after():
    arms = ArrivingArms()
    assert separated(arms, (450.0, 300.0), (600.0, 320.0)).status == "SUCCESS"
    moves = [entry[1] for entry in arms.log if entry[0] == "move"]
    down, lifted, parted, laid = moves[1:5]
    assert lifted["left"][2] == pytest.approx(down["left"][2] + LIFT_M)
    assert parted["right"][0] - parted["left"][0] == pytest.approx(2.0 * REACH_X_M, abs=2e-3)
    assert laid["right"][2] == pytest.approx(down["right"][2])


def test_a_span_that_is_blocked_is_tried_shorter():
    arms = ArrivingArms()
    skill = SeparateEnds(arms, InlineWorker())
    skill.start({"frame": frame(), "endpoints": ends((450.0, 300.0), (600.0, 320.0))})
    while len([entry for entry in arms.log if entry[0] == "move"]) < 3:
        skill.step()
    arms.lines_blocked = 2
    while (outcome := skill.step()).status == "RUNNING":
        pass
    assert outcome.status == "SUCCESS"


def test_what_keeps_it_from_being_done_is_said():
    assert separated(ArrivingArms(), (450.0, 300.0)).reason.code == "ends.few"
    assert separated(ArrivingArms(), (450.0, 300.0), (470.0, 300.0)).reason.code == "ends.close"
    missing = ArrivingArms(held=False)
    assert separated(missing, (450.0, 300.0), (600.0, 320.0)).reason.code == "grasp.missed"
    assert missing.log[-1][0] == "move"  # it rises again
