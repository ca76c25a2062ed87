"""Mean average precision and ranks on images small enough to count by hand."""

import numpy as np
import pytest

from benchmarks.detection_scoring import Truth, claims, mean_average_precision, ranks

SEGMENTS = np.full((10, 30), -1, np.int16)
SEGMENTS[:, :10], SEGMENTS[:, 10:20], SEGMENTS[5:, 20:] = 0, 1, 2


def truth(counted=(True, True, True)):
    return Truth(SEGMENTS, np.array([4, 2, 0]), np.array(counted))


def sure(*names):
    return np.eye(5)[list(names)]


def test_what_is_found_and_named_right_scores_one():
    assert mean_average_precision([claims(truth(), SEGMENTS, sure(4, 2, 0))]) == pytest.approx(1.0)
    assert ranks(truth(), SEGMENTS, sure(4, 2, 0)).tolist() == [1, 1, 1]


def test_one_of_three_names_wrong_takes_a_third():
    value = mean_average_precision([claims(truth(), SEGMENTS, sure(4, 3, 0))])
    assert value == pytest.approx(2 / 3)


def test_a_box_that_covers_sixty_percent_counts_at_three_of_ten_overlaps():
    found = SEGMENTS.copy()
    found[6:, :10] = -1
    value = mean_average_precision([claims(truth(), found, sure(4, 2, 0))])
    assert value == pytest.approx((0.3 + 1.0 + 1.0) / 3, abs=0.04)


def test_a_surer_claim_that_is_wrong_halves_precision():
    chances = np.zeros((3, 5))
    chances[0, 4], chances[1, 4], chances[1, 2], chances[2, 0] = 0.6, 0.7, 0.2, 0.9
    value = mean_average_precision([claims(truth(), SEGMENTS, chances)])
    assert value == pytest.approx((0.5 + 1.0 + 1.0) / 3, abs=0.01)


def test_what_is_hardly_shown_is_neither_asked_for_nor_held_against_anyone():
    hidden = truth((True, True, False))
    value = mean_average_precision([claims(hidden, SEGMENTS, sure(4, 2, 4))])
    assert value == pytest.approx(1.0)
    assert ranks(hidden, SEGMENTS, sure(4, 2, 4)).tolist() == [1, 1]


def test_ranks_count_what_is_likelier_and_what_is_not_found_has_none():
    chances = np.array([[0.1, 0.2, 0.3, 0.25, 0.15], [0.0, 0.0, 1.0, 0.0, 0.0]])
    found = np.where(SEGMENTS == 2, -1, SEGMENTS).astype(np.int16)
    assert ranks(truth(), found, chances).tolist() == [4, 1, 0]


def test_claims_of_several_images_are_ordered_together():
    good = claims(truth(), SEGMENTS, 0.6 * sure(4, 2, 0))
    bad = claims(truth(), SEGMENTS, 0.9 * sure(2, 0, 4))
    value = mean_average_precision([good, bad])
    # Half are found, each behind a surer claim that is wrong.
    assert value == pytest.approx(0.5 * 51 / 101, abs=0.01)
