import cv2
import numpy as np
import pytest

pytest.importorskip("torch")

from perception.cable.observation import observe  # after the skip
from perception.cable.parts import TRACER
from perception.cable.tracers.posterior import PosteriorTracer
from perception.cable.types import Endpoint
from perception.models.store import FOLDER


@pytest.fixture(scope="module")
def tracer():
    return PosteriorTracer(FOLDER / TRACER, observe)


def _arc():
    """Draw a gently bent cable; returns image and centre line."""
    turn = np.linspace(0.3, 0.3 + 0.8 * np.pi, 240)
    line = np.column_stack([200.0 + 130.0 * np.cos(turn), 120.0 + 130.0 * np.sin(turn)])
    image = np.full((330, 400), 50.0, np.float32)
    cv2.polylines(
        image, [np.round(line * 8).astype(np.int32)[:, None]], False, 190.0, 6, cv2.LINE_AA, 3
    )
    image += np.random.default_rng(0).normal(0.0, 3.0, image.shape)
    return image.clip(0, 255).astype(np.uint8), line


def _end(line, at, ahead):
    way = line[at + ahead] - line[at]
    return Endpoint(line[at], way / np.linalg.norm(way), 0.6)


def test_ends_are_believed_where_the_cable_stops_and_not_where_it_goes_on(tracer):
    image, line = _arc()
    true = [_end(line, 0, 8), _end(line, -1, -8)]
    # As a mask that breaks would show them: both face away from the break.
    false = [_end(line, 120, 8), _end(line, 110, -8)]
    judged = tracer.judged(image, [*false, *true])
    beliefs = [end.probability for end in judged]
    assert beliefs == sorted(beliefs, reverse=True)
    assert {tuple(end.position_px) for end in judged[:2]} == {tuple(e.position_px) for e in true}
    assert beliefs[1] > 0.5 > 0.1 > beliefs[2]


def test_what_is_judged_keeps_its_place_and_way(tracer):
    image, line = _arc()
    (judged,) = tracer.judged(image, [_end(line, 0, 8)])
    assert np.array_equal(judged.position_px, line[0])
    assert np.array_equal(judged.direction, _end(line, 0, 8).direction)


def test_where_no_end_is_seen_the_cable_is_followed_to_its_ends(tracer):
    image, line = _arc()
    found = tracer.judged(image, [])
    assert len(found) == 2
    for own, inwards in ((line[0], line[20]), (line[-1], line[-20])):
        end = min(found, key=lambda end: np.linalg.norm(end.position_px - own))
        assert np.linalg.norm(end.position_px - own) < 12.0
        assert float(end.direction @ (inwards - own)) > 0.0
        assert end.probability > 0.5


def test_where_no_cable_is_there_is_nothing_to_judge(tracer):
    image, line = _arc()
    assert tracer.judged(np.full_like(image, 50), []) == ()
    assert tracer.judged(np.full_like(image, 50), [_end(line, 0, 8)])[0].probability <= 0.6
