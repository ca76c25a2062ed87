import numpy as np
import pytest

pytest.importorskip("torch")

from perception.cable.tracers.evidence import FEATURES, NONE_FEATURES
from perception.cable.types import TraceEnd
from perception.training.trace_posterior import Example, draw_task, figures, fit, is_right

THERE, LOST = FEATURES.index("there"), FEATURES.index("lost")


def _examples(rng, count):
    """Return answers that are right as often as weights of 1.5 and -2 say."""
    made = []
    for _ in range(count):
        features = np.zeros((3, len(FEATURES)))
        features[:, THERE] = -rng.uniform(0.0, 4.0, 3)
        features[:, LOST] = rng.random(3) < 0.3
        none = np.array([1.0, *np.zeros(len(NONE_FEATURES) - 1)])
        odds = np.exp(np.append(features[:, THERE] * 1.5 - features[:, LOST] * 2.0, -2.0))
        answer = rng.choice(4, p=odds / odds.sum())
        made.append(Example(features, none, np.arange(3) == answer))
    return made


def test_the_fit_finds_the_weights_that_made_the_answers_and_its_beliefs_hold():
    rng = np.random.default_rng(4)
    weights = fit(_examples(rng, 600))
    assert weights.trace["there"] == pytest.approx(1.5, abs=0.3)
    assert weights.trace["lost"] == pytest.approx(-2.0, abs=0.5)
    assert weights.none["one"] == pytest.approx(-2.0, abs=0.4)
    measured = figures(_examples(rng, 600), weights)
    assert measured["calibration_error"] < 0.1
    assert measured["error_of_surest_80"] < 1.0 - measured["right"]


def test_what_speaks_against_a_trace_is_never_taken_to_speak_for_it():
    rng = np.random.default_rng(5)
    misled = [
        Example(np.where(np.arange(len(FEATURES)) == LOST, one.right[:, None], 0.0), *rest)
        for one in _examples(rng, 60)
        for rest in [(one.none, one.right)]
    ]
    weights = fit(misled)
    assert weights.trace["lost"] == pytest.approx(0.0, abs=1e-6)


def test_tasks_start_at_ends_in_view_and_the_truth_is_right():
    for number in range(4):
        task = draw_task(np.random.default_rng([11, number]))
        size = np.array(task.scene.image.shape[::-1])
        assert ((task.line_px >= 0.0) & (task.line_px <= size)).all()
        assert np.linalg.norm(task.start_px[0] - task.line_px[0]) < task.width_px
        end, other = (TraceEnd.EDGE, TraceEnd.ENDPOINT)[:: -1 if not task.leaves else 1]
        assert is_right(task, task.line_px, end)
        assert not is_right(task, task.line_px, other)
        assert not is_right(task, task.line_px[: len(task.line_px) // 2], end)
        for known in task.endpoints:
            assert ((known.position_px > 0.0) & (known.position_px < size)).all()
