from itertools import pairwise

import numpy as np
import pytest

from executive.core.errors import InputError
from perception.cable.tracers.evidence import FEATURES, NONE_FEATURES, doubts, evidence
from perception.cable.tracers.hypotheses import FLOOR, Hypothesis, hypotheses, same
from perception.cable.tracers.paths import Detour, Ends, Path
from perception.cable.tracers.posterior import (
    TracePosterior,
    Weights,
    posterior_of,
    read_weights,
)
from perception.cable.tracers.survey import Survey
from perception.cable.types import Trace, TraceEnd
from perception.models.frames import ScaledImage
from perception.models.tracer_crop import STEP

IMAGE = ScaledImage(np.zeros((400, 400), np.uint8), 1.0, 0.0)
LEFT, RIGHT, BELOW = np.array([[40.0, 200.0], [40.0 + 30 * STEP, 200.0], [40.0, 380.0]])
STRAIGHT = np.linspace(LEFT, RIGHT, 31)
# Parts from the straight line for a while, comes back to it and goes on along it.
BOW = STRAIGHT + np.outer(
    np.r_[np.zeros(8), 60 * np.sin(np.linspace(0, np.pi, 15)), np.zeros(8)], [0.0, -1.0]
)
# Runs along it first and leaves it for good.
AWAY = np.vstack([STRAIGHT[:12], STRAIGHT[11] + STEP * np.arange(1, 12)[:, None] * (0.6, 0.8)])


def _path(points, log=-0.1, end=TraceEnd.ENDPOINT, detours=()):
    return Path(points, np.linspace(0.0, log, len(points)), end, detours)


def _survey(there, back, cable=None):
    ends = Ends(
        np.array([LEFT, RIGHT, BELOW]), np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, -1.0]]), np.ones(3)
    )
    mask = np.zeros((400, 400), np.uint8) if cable is None else cable
    return Survey(IMAGE, mask, 1.0, ends, (tuple(there), tuple(back), ()))


def _mask(*lines):
    mask = np.zeros((400, 400), np.uint8)
    for line in lines:
        for start, end in pairwise(line):
            for x, y in np.linspace(start, end, 20):
                mask[round(y) - 2 : round(y) + 3, round(x) - 2 : round(x) + 3] = 1
    return mask


def _weights(**given):
    trace = {name: given.get(name, 0.0) for name in FEATURES}
    return Weights(trace=trace, none=dict.fromkeys(NONE_FEATURES, 0.0))


def _column(found, name):
    return evidence(found, 0, hypotheses(found, 0))[:, FEATURES.index(name)]


def test_a_trace_found_from_both_ends_is_one_trace_with_both_beliefs():
    found = _survey([_path(STRAIGHT)], [_path(STRAIGHT[::-1])])
    (one,) = hypotheses(found, 0)
    assert (one.end, one.reached, one.joined) == (TraceEnd.ENDPOINT, 1, False)
    assert (one.there, one.back) == pytest.approx((0.0, 0.0))
    assert np.array_equal(one.points[[0, -1]], [LEFT, RIGHT])


def test_from_the_other_end_the_same_traces_are_found_turned_round():
    found = _survey([_path(STRAIGHT)], [_path(BOW[::-1])])
    there, back = hypotheses(found, 0), hypotheses(found, 1)
    assert len(there) == len(back)
    for one in there:
        turned = Hypothesis(one.points[::-1], TraceEnd.ENDPOINT, 0)
        assert any(same(turned, other) for other in back)


def test_another_way_that_a_path_might_have_gone_is_a_trace_of_its_own():
    detour = Detour(7, 23, BOW[8:23], 1.2)
    found = _survey([_path(STRAIGHT, detours=(detour,))], [])
    straight, bow = hypotheses(found, 0)
    assert np.array_equal(bow.points, BOW)
    assert straight.there - bow.there == pytest.approx(1.2)


def test_paths_that_were_lost_from_both_sides_join_where_they_run_together():
    lost_there = _path(AWAY, end=TraceEnd.LOST)
    back = np.vstack([STRAIGHT[:3:-1], STRAIGHT[4] + STEP * np.arange(1, 9)[:, None] * (-0.6, 0.8)])
    found = _survey([lost_there], [_path(back, end=TraceEnd.LOST)])
    joined = [one for one in hypotheses(found, 0) if one.joined]
    assert any(same(one, Hypothesis(STRAIGHT, TraceEnd.ENDPOINT, 1)) for one in joined)
    assert all(one.there == one.back == FLOOR for one in joined)


def test_cable_that_a_trace_leaves_out_and_lines_beside_the_cable_show():
    found = _survey([_path(STRAIGHT), _path(BOW, -1.0)], [], _mask(BOW))
    straight, bow = _column(found, "unexplained")
    assert straight > 1.0 > 0.2 > bow
    straight, bow = _column(found, "off_cable")
    assert straight > 1.0 > 0.2 > bow


def test_a_trace_along_what_another_end_belongs_to_shows():
    other = _path(np.vstack([BELOW, STRAIGHT[:12]]))
    found = _survey([_path(STRAIGHT)], [_path(STRAIGHT[::-1])], _mask(STRAIGHT))
    crossed = Survey(found.image, found.cable, 1.0, found.ends, (*found.found[:2], (other,)))
    assert _column(found, "shared")[0] == 0.0
    assert _column(crossed, "shared")[0] > 1.0


def test_evidence_does_not_depend_on_the_size_of_the_mask():
    small, large = _survey([_path(STRAIGHT)], [], _mask(BOW)), _mask(BOW)
    doubled = np.kron(large, np.ones((2, 2), np.uint8))
    finer = Survey(IMAGE, doubled, 2.0, small.ends, small.found)
    one, other = (evidence(found, 0, hypotheses(found, 0)) for found in (small, finer))
    assert one == pytest.approx(other, abs=0.1)


def test_beliefs_add_up_and_the_likeliest_comes_first():
    found = _survey([_path(STRAIGHT), _path(BOW, -1.0)], [_path(STRAIGHT[::-1])], _mask(STRAIGHT))
    posterior = posterior_of(found, 0, _weights(there=1.0, back=0.5, unexplained=-1.0))
    beliefs = [trace.probability for trace in posterior.traces]
    assert sum(beliefs) + posterior.none == pytest.approx(1.0)
    assert beliefs == sorted(beliefs, reverse=True)
    assert posterior.best is posterior.traces[0]
    assert posterior.best.points_px[-1] == pytest.approx(RIGHT)


def test_doubt_of_the_searches_speaks_for_none():
    sure, unsure = (_survey([_path(STRAIGHT, log)], []) for log in (-0.1, -3.0))
    assert (doubts(unsure, 0) >= doubts(sure, 0)).all()
    weights = Weights(
        trace=dict.fromkeys(FEATURES, 0.0), none={**dict.fromkeys(NONE_FEATURES, 0.0), "doubt": 1.0}
    )
    assert posterior_of(unsure, 0, weights).none > posterior_of(sure, 0, weights).none


def test_samples_come_as_often_as_they_are_believed():
    traces = tuple(Trace(STRAIGHT, TraceEnd.ENDPOINT, p) for p in (0.6, 0.3))
    posterior, rng = TracePosterior(traces, 0.1), np.random.default_rng(0)
    drawn = [posterior.sample(rng) for _ in range(2000)]
    for wanted, belief in ((traces[0], 0.6), (traces[1], 0.3), (None, 0.1)):
        assert sum(one is wanted for one in drawn) / 2000 == pytest.approx(belief, abs=0.04)


def test_weights_that_are_missing_or_of_other_features_are_refused(tmp_path):
    with pytest.raises(InputError, match=r"no weights of evidence; .* try python -m"):
        read_weights(tmp_path / "posterior.json")
    (tmp_path / "posterior.json").write_text('{"trace": {"colour": 1.0}, "none": {}}')
    with pytest.raises(InputError, match=r"got features .*colour"):
        read_weights(tmp_path / "posterior.json")
