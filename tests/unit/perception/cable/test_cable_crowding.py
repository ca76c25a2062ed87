import numpy as np

from perception.cable.crowding import MOST_BELIEF, doubt_shared
from perception.cable.types import Crossing


def at(x_px, y_px, probability=0.998):
    return Crossing(np.array([x_px, y_px]), 0, 0.2, 0, 0.6, probability)


def test_only_crossings_that_share_a_place_are_doubted():
    found = doubt_shared([at(100.0, 100.0), at(103.0, 101.0), at(160.0, 100.0)])
    assert [crossing.probability for crossing in found] == [MOST_BELIEF, MOST_BELIEF, 0.998]


def test_what_is_doubted_already_is_not_believed_more():
    found = doubt_shared([at(100.0, 100.0, 0.6), at(101.0, 100.0, 0.9)])
    assert [crossing.probability for crossing in found] == [0.6, MOST_BELIEF]


def test_few_crossings_stay_as_they_are():
    assert doubt_shared([]) == ()
    assert doubt_shared([at(1.0, 2.0)])[0].probability == 0.998
