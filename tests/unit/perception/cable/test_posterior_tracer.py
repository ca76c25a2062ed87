import cv2
import numpy as np
import pytest

pytest.importorskip("torch")

from perception.cable.interfaces import HypothesisTracer  # after the skip
from perception.cable.observation import observe
from perception.cable.parts import TRACER
from perception.cable.tracers.posterior import PosteriorTracer
from perception.cable.types import Endpoint, TraceEnd
from perception.models.store import FOLDER


@pytest.fixture(scope="module")
def tracer():
    return PosteriorTracer(FOLDER / TRACER, observe)


def _loop(bright):
    """Draw a cable with one loop; returns image, centre line and both ends."""
    turn = np.linspace(-0.75 * np.pi, 0.75 * np.pi, 120)
    loop = np.column_stack([230.0 + 70.0 * np.cos(turn), 170.0 + 70.0 * np.sin(turn)])
    run = np.linspace(0.0, 1.0, 60)[:, None]
    line = np.vstack(
        [loop[0] + (1.0 - run) * (-80.0, 80.0), loop, loop[-1] + run[1:] * (-80.0, -80.0)]
    )
    image = np.full((330, 360), 50.0 if bright else 190.0, np.float32)
    fixed = np.round(line * 8).astype(np.int32)[:, None]
    cv2.polylines(image, [fixed], False, 190.0 if bright else 50.0, 6, cv2.LINE_AA, 3)
    image += np.random.default_rng(0).normal(0.0, 3.0, image.shape)
    ends = [
        Endpoint(own[0], (own[8] - own[0]) / np.linalg.norm(own[8] - own[0]), 1.0)
        for own in (line, line[::-1])
    ]
    return image.clip(0, 255).astype(np.uint8), line, ends


def _farthest(line, trace):
    arcs = np.linspace(0.0, len(trace.points_px) - 1.0, 400)
    dense = [np.interp(arcs, np.arange(len(trace.points_px)), axis) for axis in trace.points_px.T]
    gaps = np.linalg.norm(line[::4, None] - np.column_stack(dense)[None], axis=2)
    return gaps.min(axis=1).max()


# The eye that is used here sees bright cables alone; a dark one is looked for at the start.
@pytest.mark.parametrize("bright", [True, False])
def test_a_plain_loop_is_followed_and_believed_from_either_end(tracer, bright):
    assert isinstance(tracer, HypothesisTracer)
    image, line, ends = _loop(bright)
    for own, end in zip((line, line[::-1]), ends, strict=True):
        posterior = tracer.posterior(image, end.position_px, ends)
        assert posterior.best.end is TraceEnd.ENDPOINT
        assert _farthest(own, posterior.best) < 6.0
        assert posterior.best.points_px[[0, -1]] == pytest.approx(own[[0, -1]], abs=6.0)
        assert posterior.best.probability > 0.7


def test_the_same_question_has_the_same_answer(tracer):
    image, line, ends = _loop(bright=True)
    one, other = (tracer.hypotheses(image, line[:20:4], ends) for _ in range(2))
    assert len(one) == len(other)
    for first, second in zip(one, other, strict=True):
        assert np.array_equal(first.points_px, second.points_px)
        assert first.probability == second.probability


def test_where_no_cable_is_nothing_is_believed(tracer):
    posterior = tracer.posterior(np.full((200, 200), 50, np.uint8), np.array([[80.0, 90.0]]), [])
    assert (posterior.best, posterior.none) == (None, 1.0)
