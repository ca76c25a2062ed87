from dataclasses import replace

import numpy as np
import pytest
from cell_fakes import ArrivingArms, finished, frame

from executive.core.work import InlineWorker
from skills.cable.check_drape import CheckDrape
from skills.cable.heights import heights_m
from skills.cable.shake_off import ShakeOff


class SeesAStrand:
    """Sees cable along row 300."""

    def cable_pixels(self, image):
        cable = np.zeros(image.shape, dtype=bool)
        cable[298:303, 200:800] = True
        return cable


def looked(height_m: float):
    """A frame whose cable lies on the table up to column 600 and rises from there."""
    level = frame()
    depth_m = np.full(level.image.shape, 1.0, dtype=np.float32)
    depth_m[298:303, 600:800] -= height_m
    return replace(level, depth_m=depth_m)


def checked(height_m: float):
    return finished(CheckDrape(SeesAStrand(), InlineWorker()), {"frame": looked(height_m)})[0]


def test_cable_on_the_table_is_no_drape_and_cable_over_an_arm_is():
    assert checked(0.012).status == "SUCCESS"
    assert checked(0.15).reason.code == "cable.draped"


def test_hands_go_down_and_are_drawn_back_from_under_the_cable():
    arms = ArrivingArms()
    outcome, _ = finished(ShakeOff(arms, InlineWorker()), {})
    moves = [entry[1] for entry in arms.log if entry[0] == "move"]
    assert outcome.status == "SUCCESS"
    assert moves[0]["left"][2] < 0.05
    assert moves[1]["right"][1] < moves[0]["right"][1]


def test_heights_are_those_above_the_table_and_nothing_is_made_of_unknown_depth():
    seen = looked(0.1)
    seen.depth_m[300, 700] = np.nan
    points = np.array([[300.0, 300.0], [650.0, 300.0], [700.0, 300.0]])
    assert heights_m(seen, points) == pytest.approx([0.0, 0.1, 0.0], abs=1e-4)
    assert heights_m(seen, np.empty((0, 2))).shape == (0,)
