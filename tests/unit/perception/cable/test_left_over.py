"""What traces leave over, and ends that two of them share, make them doubtful."""

import numpy as np
import pytest
from synthetic_cable import Drawing, evenly, render

from perception.cable.left_over import STILL_BELIEVED, doubt_left_over, largest_left
from perception.cable.observation import observe
from perception.cable.types import Endpoint, Trace, TraceEnd
from perception.cable.vision import GreyImageVision

WIDTH_PX = 7.0
LINE = evenly(np.c_[np.linspace(120.0, 900.0, 90), np.full(90, 400.0), np.zeros(90)])


def _image(nodes: np.ndarray) -> np.ndarray:
    return render(Drawing(nodes), np.random.default_rng(3), width_px=WIDTH_PX, connectors=False)


def _trace(points_px: np.ndarray, probability: float = 0.9) -> Trace:
    return Trace(points_px, TraceEnd.ENDPOINT, probability)


def test_a_trace_that_leaves_a_large_piece_is_believed_less():
    seen, line = observe(_image(LINE)), Drawing(LINE).points_px
    whole, half = _trace(line), _trace(line[: len(line) // 2])
    ((kept,), (_,)) = doubt_left_over(seen, [(whole,), (half,)])
    assert kept.probability == whole.probability
    (told,) = doubt_left_over(seen, [(half, whole)])
    assert told[0].probability == whole.probability
    assert told[1].probability == pytest.approx(STILL_BELIEVED * half.probability)


def test_what_another_trace_explains_is_not_left_over():
    seen, line = observe(_image(LINE)), Drawing(LINE).points_px
    first, rest = _trace(line[: len(line) // 2]), _trace(line[len(line) // 2 - 1 :])
    assert largest_left(seen, first, []) > 10.0
    assert largest_left(seen, first, [rest]) == 0.0


def test_what_goes_out_of_view_may_be_another_cable():
    across = evenly(np.c_[np.full(90, 500.0), np.linspace(-80.0, 1200.0, 90), np.full(90, 8.0)])
    image = np.maximum(_image(LINE), _image(across))
    assert largest_left(observe(image), _trace(Drawing(LINE).points_px), []) < 2.0


class FalseEnd:
    """Takes a place on a straight cable for an end, as long as that is among the ends."""

    def trace(self, image, start_px, endpoints):
        del image
        ends_px = np.array(sorted((end.position_px for end in endpoints), key=lambda at: at[0]))
        here = int(np.abs(ends_px[:, 0] - start_px[0, 0]).argmin())
        there = here + 1 if here == 0 else here - 1
        return _trace(np.linspace(ends_px[here], ends_px[there], 200))


def test_where_two_traces_come_to_one_end_it_may_be_none():
    line = Drawing(LINE).points_px
    vision = GreyImageVision()
    vision._tracer = FalseEnd()
    inwards = np.array([1.0, 0.0])
    ends = (
        Endpoint(line[0], inwards, 0.99),
        Endpoint(line[-1], -inwards, 0.98),
        Endpoint(line[len(line) // 2], inwards, 0.8),
    )
    vision._ended = lambda pixels, shape: ends
    (trace,) = vision.scene(_image(LINE)).traces
    assert sorted(trace.points_px[[0, -1], 0]) == sorted(line[[0, -1], 0])
