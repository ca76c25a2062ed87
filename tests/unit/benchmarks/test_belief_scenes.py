"""The scenes that beliefs are measured on: truth, what is stated, and true answers."""

import numpy as np
import pytest

from benchmarks.beliefs import DECIDED, POLICIES, _course, look
from perception.cable.belief import diagram_probability
from perception.cable.topology.names import UNKNOWN


@pytest.fixture(scope="module")
def scenes():
    rng = np.random.default_rng(4)
    return [look(rng, stated=bool(k % 2)) for k in range(8)]


def test_true_answers_to_all_questions_lead_to_the_truth(scenes):
    for seen in scenes:
        assert seen.knot != UNKNOWN
        known = seen
        for k in range(len(seen.reading.crossings)):
            known = known.answered(k)
        assert known.wrong == frozenset()
        assert abs(known.knotted - (seen.knot != "0_1")) < 0.05


def test_crossings_are_wrong_about_as_often_as_they_say():
    rng = np.random.default_rng(5)
    said, wrong, count = 0.0, 0, 0
    for _ in range(25):
        seen = look(rng, stated=True)
        said += sum(1.0 - crossing.probability for crossing in seen.reading.crossings)
        wrong += len(seen.wrong)
        count += len(seen.reading.crossings)
    assert wrong / count == pytest.approx(said / count, abs=3.0 * np.sqrt(0.1 / count))


@pytest.mark.parametrize("name", POLICIES)
def test_questions_end_when_the_belief_is_sure_or_nothing_is_left(name, scenes):
    rng = np.random.default_rng(6)
    for seen in scenes:
        course = _course(seen, POLICIES[name], rng)
        first = diagram_probability(seen.reading.trace, 0, seen.reading.crossings)
        assert course[0] == pytest.approx(first)
        assert len(course) - 1 <= len(seen.reading.crossings)
        assert all(max(p, 1.0 - p) <= DECIDED for p in course[:-1])
