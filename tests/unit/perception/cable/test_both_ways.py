import numpy as np
import pytest

from perception.cable.tracers.both_ways import BothWaysTracer
from perception.cable.types import Endpoint, Trace, TraceEnd

IMAGE = np.zeros((10, 10), np.uint8)
STRAIGHT = np.column_stack([np.linspace(0.0, 200.0, 41), np.zeros(41)])
BOW = STRAIGHT + np.column_stack([np.zeros(41), 30.0 * np.sin(np.linspace(0.0, np.pi, 41))])
ENDS = [Endpoint(STRAIGHT[-1], np.array([-1.0, 0.0]), 1.0)]


class Scripted:
    """Gives one trace from the left end, another one from the right end."""

    def __init__(self, there, back):
        self.traces, self.asked = {0.0: there, 200.0: back}, 0

    def trace(self, image, start_px, endpoints):
        self.asked += 1
        return self.traces[float(np.atleast_2d(start_px)[0, 0])]


def _trace(points, probability, end=TraceEnd.ENDPOINT):
    return Trace(points, end, probability)


def _both(there, back):
    tracer = Scripted(there, back)
    return BothWaysTracer(tracer).trace(IMAGE, STRAIGHT[:3], ENDS), tracer.asked


def test_ways_that_agree_support_each_other():
    trace, _ = _both(_trace(STRAIGHT, 0.8), _trace(STRAIGHT[::-1], 0.9))
    assert 0.9 < trace.probability < 1.0
    assert np.array_equal(trace.points_px, STRAIGHT)


def test_a_doubtful_look_takes_nothing_from_the_other_when_they_agree():
    trace, _ = _both(_trace(STRAIGHT, 0.8), _trace(STRAIGHT[::-1], 0.3))
    assert trace.probability == pytest.approx(0.8)


@pytest.mark.parametrize(("there", "back"), [(0.8, 0.4), (0.4, 0.8)])
def test_of_ways_that_differ_the_likelier_stays_and_is_doubted(there, back):
    trace, _ = _both(_trace(STRAIGHT, there), _trace(BOW[::-1], back))
    kept = STRAIGHT if there > back else BOW
    assert np.array_equal(trace.points_px, kept)
    assert trace.probability < 0.8


def test_sure_traces_and_those_without_an_end_are_not_followed_back():
    for there in (_trace(STRAIGHT, 0.99), _trace(STRAIGHT, 0.5, TraceEnd.EDGE)):
        trace, asked = _both(there, None)
        assert (trace, asked) == (there, 1)


def test_a_way_back_that_comes_to_nowhere_changes_nothing():
    there = _trace(STRAIGHT, 0.6)
    assert _both(there, None)[0] is there
    assert _both(there, _trace(STRAIGHT[:10:-1], 0.9, TraceEnd.LOST))[0] is there
