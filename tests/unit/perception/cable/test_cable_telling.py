"""What to ask next: information is exact, never negative, and leads to sure beliefs."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from synthetic_cable import WIDTH_PX, figure_8, laid_down, overhand

from perception.cable.belief import (
    any_knotted,
    chances,
    diagram_probability,
    knot_types,
    knotted_probability,
    reading_of,
)
from perception.cable.crossings import decide, find_sites, strand_of
from perception.cable.outcomes import outcomes
from perception.cable.parting import parting_arc
from perception.cable.telling import (
    about_type,
    crossing_questions,
    entropy,
    path_questions,
    telling_question,
)
from perception.cable.topology import close_over, curve_crossings
from perception.cable.types import QuestionKind, Reading, Trace, TraceEnd


def seen(drawing, sure):
    """The reading of a drawing with its true crossings, with these probabilities."""
    trace = Trace(drawing.points_px, TraceEnd.ENDPOINT, 1.0)
    sites = find_sites((trace,), WIDTH_PX)
    over = [crossing.first_over for crossing in curve_crossings(drawing.nodes).crossings]
    sure = [sure] * len(sites) if isinstance(sure, float) else sure
    crossings = [
        decide(site, p if first_over else 1.0 - p)
        for site, first_over, p in zip(sites, over, sure, strict=True)
    ]
    return Reading(trace, tuple(crossings))


def believed(reading, share):
    return replace(reading, trace=replace(reading.trace, probability=share))


def binary_entropy(p):
    return entropy({"yes": p, "no": 1.0 - p})


def test_types_add_up_and_agree_with_the_belief_in_a_knot():
    for drawing in (overhand(), figure_8()):
        reading = seen(drawing, 0.9)
        types = knot_types([reading])
        assert sum(one.probability for one in types) == pytest.approx(1.0)
        assert [one.probability for one in types] == sorted(
            (one.probability for one in types), reverse=True
        )
        unknotted = sum(one.probability for one in types if one.name == "0_1")
        knotted = knotted_probability((reading.trace,), reading.crossings)
        assert 1.0 - unknotted == pytest.approx(knotted)


def test_an_overhand_has_a_hand_and_its_mirror_image_the_other():
    reading = seen(overhand(), 0.999)
    mirrored = replace(
        reading,
        crossings=tuple(
            replace(c, arc_over=c.arc_under, arc_under=c.arc_over) for c in reading.crossings
        ),
    )
    names = {knot_types([one])[0].name for one in (reading, mirrored)}
    assert names == {"3_1 left", "3_1 right"}


def test_mixtures_weigh_readings_and_leave_the_rest_unknown():
    knot, none = seen(overhand(), 0.9999), seen(laid_down(overhand()), 0.9999)
    readings = [believed(knot, 0.5), believed(none, 0.3)]
    types = {one.name.split()[0]: one.probability for one in knot_types(readings)}
    assert types["3_1"] == pytest.approx(0.5, abs=0.01)
    assert types["0_1"] == pytest.approx(0.3, abs=0.01)
    assert types["unknown"] == pytest.approx(0.2, abs=1e-6)
    assert any_knotted([readings]) == pytest.approx(0.5 + 0.5 * 0.2, abs=0.01)
    assert any_knotted([]) == 0.5
    assert any_knotted([[]]) == 0.5


def test_one_reading_of_each_cable_is_what_traces_and_crossings_say():
    reading = seen(figure_8(), 0.8)
    assert any_knotted([[reading]]) == knotted_probability((reading.trace,), reading.crossings)
    assert reading_of(reading.trace, 0, reading.crossings).crossings == reading.crossings


def test_crossings_that_part_the_cable_in_two_are_not_tried_out():
    reading = seen(overhand(), 0.8)
    listed = outcomes(reading)
    idle = [k for k in range(len(listed.crossings)) if not listed.flipped[:, k].any()]
    assert len(idle) == 1  # The tails' own crossing.
    assert listed.weights.sum() == pytest.approx(1.0)


def test_information_is_what_the_entropy_falls_by_on_average():
    reading = seen(figure_8(), [0.9, 0.7, 0.8, 0.6, 0.95][: len(seen(figure_8(), 0.9).crossings)])
    before = binary_entropy(diagram_probability(reading.trace, 0, reading.crossings))
    questions = crossing_questions([reading])
    for k, question in enumerate(questions):
        after = 0.0
        crossing = reading.crossings[k]
        for p, answer in (
            (crossing.probability, replace(crossing, probability=1.0 - 1e-12)),
            (
                1.0 - crossing.probability,
                replace(
                    crossing,
                    arc_over=crossing.arc_under,
                    arc_under=crossing.arc_over,
                    probability=1.0 - 1e-12,
                ),
            ),
        ):
            told = (*reading.crossings[:k], answer, *reading.crossings[k + 1 :])
            after += p * binary_entropy(diagram_probability(reading.trace, 0, told))
        assert question.kind is QuestionKind.CROSSING
        assert question.bits == pytest.approx(before - after, abs=5e-3)
        assert question.bits >= 0.0


def test_the_only_open_crossing_tells_all_that_is_unknown():
    for open_one in range(3):
        crossings = seen(overhand(), 1.0 - 1e-9).crossings
        reading = seen(overhand(), 1.0 - 1e-9)
        knotty = [
            k for k in range(len(crossings)) if outcomes(seen(overhand(), 0.8)).flipped[:, k].any()
        ]
        k = knotty[open_one]
        unsure = replace(crossings[k], probability=0.5)
        reading = Reading(reading.trace, (*crossings[:k], unsure, *crossings[k + 1 :]))
        question = telling_question([reading])
        assert question.bits == pytest.approx(1.0, abs=1e-3)
        np.testing.assert_allclose(question.position_px, crossings[k].position_px)


def test_which_knot_it_is_leaves_more_to_ask_than_whether_it_is_one():
    reading = seen(figure_8(), 0.75)
    pairs = zip(
        crossing_questions([reading]), crossing_questions([reading], about_type), strict=True
    )
    assert all(coarse.bits <= fine.bits + 1e-9 for coarse, fine in pairs)


def test_readings_that_see_the_same_crossing_learn_from_the_same_answer():
    reading = seen(overhand(), 0.7)
    backwards = Reading(
        replace(reading.trace, points_px=reading.trace.points_px[::-1]),
        tuple(
            replace(c, arc_over=1.0 - c.arc_over, arc_under=1.0 - c.arc_under)
            for c in reading.crossings
        ),
    )
    alone = crossing_questions([reading])
    both = crossing_questions([believed(reading, 0.6), believed(backwards, 0.4)])
    for one, other in zip(alone, both, strict=True):
        assert other.bits == pytest.approx(one.bits, abs=2e-2)


def test_where_readings_part_is_asked_for():
    knot, none = seen(overhand(), 0.9999), seen(laid_down(overhand()), 0.9999)
    points = knot.trace.points_px
    turned = np.vstack([points[:120], points[120] + np.outer(np.arange(1, 60), [2.1, -2.1])])
    other = Reading(Trace(turned, TraceEnd.ENDPOINT, 0.5), ())
    (question,) = path_questions([believed(knot, 0.5), other])
    assert question.kind is QuestionKind.PATH
    assert np.linalg.norm(question.position_px - points[120]) < 30.0
    # A knot with one half, none with the other: the answer tells nearly one bit.
    assert question.bits == pytest.approx(1.0, abs=0.02)
    assert path_questions([believed(knot, 0.5), believed(none, 0.5)]) == ()
    assert telling_question([believed(knot, 0.5), other]).kind is QuestionKind.PATH


def test_forks_that_lead_to_the_same_knot_tell_nothing():
    knot = seen(laid_down(overhand()), 0.9999)
    points = knot.trace.points_px
    turned = np.vstack([points[:120], points[120] + np.outer(np.arange(1, 60), [2.1, -2.1])])
    other = Reading(Trace(turned, TraceEnd.ENDPOINT, 0.5), ())
    (question,) = path_questions([believed(knot, 0.5), other])
    assert question.bits < 0.01


def test_nothing_is_asked_about_nothing():
    assert telling_question([]) is None
    assert telling_question([Reading(Trace(np.eye(2) * 50, TraceEnd.ENDPOINT, 1.0), ())]) is None


def test_traces_part_where_they_leave_each_other_whichever_way_round():
    line = np.c_[np.arange(0.0, 400.0, 4.0), np.zeros(100)]
    away = line.copy()
    away[50:, 1] = 2.0 * (away[50:, 0] - away[50, 0])
    for other in (away, away[::-1]):
        assert parting_arc(line, other) == pytest.approx(200.0, abs=12.0)
    assert parting_arc(line, line + 2.0) is None
    assert parting_arc(line, line[::-1]) is None
    assert parting_arc(line[:60], line) == pytest.approx(236.0, abs=12.0)


def test_entropy_is_that_of_even_chances():
    for count in (1, 2, 4, 8):
        assert entropy({str(k): 1.0 / count for k in range(count)}) == math.log2(count)


@pytest.mark.parametrize("tie", [overhand, figure_8])
def test_crossings_of_drawn_cables_can_be_drawn(tie):
    reading = seen(tie(), 0.9)
    assert close_over(strand_of(reading.trace, 0, reading.crossings)).is_planar()


def test_with_a_missed_crossing_nothing_is_known():
    reading = seen(figure_8(), 0.9)
    told = 0
    for k in range(len(reading.crossings)):
        left = reading.crossings[:k] + reading.crossings[k + 1 :]
        strand = strand_of(reading.trace, 0, left)
        if not close_over(strand).is_planar():
            told += 1
            assert chances([Reading(reading.trace, left)])["unknown"] > 0.5
    assert told >= 4


def test_who_is_on_top_does_not_matter_for_whether_it_can_be_drawn():
    reading = seen(figure_8(), 0.9)
    ways = itertools.product((False, True), repeat=len(reading.crossings))
    for flips in itertools.islice(ways, 6):
        crossings = tuple(
            replace(c, arc_over=c.arc_under, arc_under=c.arc_over) if flip else c
            for c, flip in zip(reading.crossings, flips, strict=True)
        )
        assert close_over(strand_of(reading.trace, 0, crossings)).is_planar()
