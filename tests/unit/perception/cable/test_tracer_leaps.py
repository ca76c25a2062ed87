import numpy as np
import pytest

from perception.cable.tracers.leaps import leap
from perception.cable.tracers.modes import find_modes
from perception.cable.tracers.steps import Outlook
from perception.models.frames import turned_frame
from perception.models.tracer_crop import CELL, HERE, SIZE, STEP

GRID = SIZE // CELL
FRAME = turned_frame(np.zeros(2), np.array([1.0, 0.0]), HERE)


def _belief(place, spread=0.8, beside=0.0):
    """Return a map with one mode, and some belief far from it."""
    centres = np.arange(GRID) * CELL + 0.5 * (CELL - 1)
    weights = np.outer(
        *(np.exp(-(((at - centres) / (spread * CELL)) ** 2) / 2) for at in place[::-1])
    )
    weights *= (1.0 - beside) / weights.sum()
    weights[2, 2] += beside
    return weights


def _outlook(places, crop=None, spread=0.8, beside=0.0):
    maps = np.array([_belief(place, spread, beside) for place in places])
    if crop is None:
        crop = np.zeros((3, SIZE, SIZE), np.float32)
        crop[0, 30:34] = 2.0
    return Outlook(FRAME, crop, maps[0], 0.0, maps[1:], True)


def _ahead(*sideways):
    return [(HERE[0] + STEP * (k + 1), HERE[1] + aside) for k, aside in enumerate(sideways)]


def _leapt(outlook):
    return leap(outlook, find_modes(outlook.cells, 0.05, 3)[0])


def test_a_plain_way_gives_all_steps_of_one_look():
    places = _ahead(0.0, 0.5, 0.0)
    assert np.array(_leapt(_outlook(places))) == pytest.approx(np.array(places[1:]), abs=0.3)


@pytest.mark.parametrize(
    ("places", "changes"),
    [
        pytest.param(_ahead(0, 0, 0), {"beside": 0.2}, id="another way is possible"),
        pytest.param(_ahead(0, 0, 0), {"spread": 2.5}, id="nothing is sharp"),
        pytest.param(_ahead(0, 14, 0), {}, id="a sharp turn"),
        pytest.param([*_ahead(0), (HERE[0] + 3 * STEP, HERE[1])], {}, id="a jump"),
    ],
)
def test_steps_in_doubt_get_looks_of_their_own(places, changes):
    assert _leapt(_outlook(places, **changes)) == []


def test_nothing_is_leapt_beyond_the_end_of_the_cable():
    crop = np.zeros((3, SIZE, SIZE), np.float32)
    crop[0, 30:34, : int(HERE[0] + 1.3 * STEP)] = 2.0
    assert _leapt(_outlook(_ahead(0, 0, 0), crop)) == []
