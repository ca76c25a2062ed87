import numpy as np
import pytest
from synthetic_cable import (
    SHAPE,
    WIDTH_PX,
    Drawing,
    evenly,
    laid_down,
    overhand,
    render,
)

from perception.cable.baselines.one_trace import first_trace
from perception.cable.baselines.sgtm2 import Sgtm2, first_met
from perception.cable.baselines.tusk import NOTHING_KNOWN, TuskConfig, TuskVision
from perception.cable.crossings import decide, find_sites
from perception.cable.following import followed_share
from perception.cable.sight.seen import Tangle
from perception.cable.topology import curve_crossings
from perception.cable.tracers.analytic import AnalyticTracer
from perception.cable.types import Endpoint, Trace, TraceEnd
from perception.cable.vision import GreyImageVision

ENDS = (
    Endpoint(np.array([100.0, 100.0]), np.array([1.0, 0.0]), 0.9),
    Endpoint(np.array([900.0, 100.0]), np.array([-1.0, 0.0]), 0.8),
)


class TrueClassifier:
    """Knows the heights of a drawing."""

    def __init__(self, drawing):
        self._drawing = drawing

    def classify(self, image, traces):
        del image
        nodes = self._drawing.nodes
        strand = curve_crossings(nodes)
        index = np.arange(len(nodes), dtype=float)
        found = []
        for site in find_sites(traces, WIDTH_PX):
            places = [
                [np.interp(c.first, index, nodes[:, axis]) for axis in (0, 1)]
                for c in strand.crossings
            ]
            gaps = np.linalg.norm(np.array(places) - site.position_px, axis=1)
            true = strand.crossings[int(gaps.argmin())]
            forward = np.linalg.norm(traces[0].points_px[0] - nodes[0, :2]) < 60.0
            found.append(decide(site, 0.9 if true.first_over == forward else 0.1))
        return tuple(found)


class TrueTracer:
    """Knows the line of a drawing."""

    def __init__(self, drawing):
        self._line = drawing.points_px

    def trace(self, image, start_px, endpoints):
        del image, endpoints
        gaps = np.linalg.norm(self._line[[0, -1]] - start_px[0], axis=1)
        line = self._line if gaps[0] < gaps[1] else self._line[::-1]
        return Trace(line, TraceEnd.ENDPOINT, 1.0)


def _tusk(drawing, *, cancel=True):
    return TuskVision(
        GreyImageVision(), TrueTracer(drawing), TrueClassifier(drawing), TuskConfig(cancel)
    )


def _with_a_bight_laid_over():
    """A cable that runs straight, and comes back to lie over and again over itself."""
    way = np.array(
        [
            [120.0, 400.0], [400.0, 400.0], [620.0, 400.0], [850.0, 380.0], [880.0, 250.0],
            [700.0, 220.0], [560.0, 330.0], [540.0, 470.0], [460.0, 520.0], [400.0, 440.0],
            [380.0, 330.0], [300.0, 200.0],
        ]
    )  # fmt: skip
    return laid_down(Drawing(evenly(np.column_stack([way, np.zeros(len(way))]))))


def test_tusk_finds_an_overhand_knot_and_its_first_undercrossing():
    drawing = overhand()
    image = render(drawing, np.random.default_rng(1))
    seen = _tusk(drawing).scene(image)
    assert len(seen.traces) == 1
    assert len(seen.knots) == 1
    assert seen.knotted_probability == pytest.approx(0.9**2)
    under = [np.linalg.norm(c.position_px - seen.knots[0].first_undercrossing_px)
             for c in seen.crossings]  # fmt: skip
    assert min(under) < 5.0


def test_tusk_reports_nothing_of_a_cable_laid_down_in_order():
    drawing = laid_down(overhand())
    seen = _tusk(drawing).scene(render(drawing, np.random.default_rng(2)))
    assert len(seen.crossings) >= 3
    assert seen.knots == ()
    assert seen.knotted_probability == 0.0


def test_without_cancellation_loops_are_called_knots():
    drawing = _with_a_bight_laid_over()
    image = render(drawing, np.random.default_rng(3))
    line = drawing.points_px
    # From the end that lies on top: over twice, under twice, with nothing that is tied.
    traces = [Trace(line, TraceEnd.ENDPOINT, 1.0)]
    tusk, plain = _tusk(drawing), _tusk(drawing, cancel=False)
    crossings = tusk.crossings(image, traces)
    assert len(crossings) == 2
    assert tusk.knots(image, traces, crossings) == ()
    assert len(plain.knots(image, traces, crossings)) == 1


def test_tusk_knows_nothing_without_a_trace():
    seen = _tusk(overhand()).scene(np.full(SHAPE, 60, np.uint8))
    assert seen.traces == ()
    assert seen.knotted_probability == NOTHING_KNOWN


def test_tusk_follows_the_cable_from_where_it_is_told_to_start():
    drawing = overhand()
    image = render(drawing, np.random.default_rng(4))
    seen = _tusk(drawing).scene(image, drawing.points_px[:-12:-2])
    assert seen.traces[0].points_px[0] == pytest.approx(drawing.points_px[-1])


class _Parts:
    """Gives a start at one end only."""

    def start_points(self, image, endpoint):
        del image
        clear = endpoint is ENDS[1]
        return np.stack([endpoint.position_px, endpoint.position_px + 9.0]) if clear else None


class _Straight:
    def trace(self, image, start_px, endpoints):
        del image, endpoints
        return Trace(start_px, TraceEnd.LOST, 1.0)


def test_the_first_end_that_is_clear_is_where_a_trace_starts():
    traces = first_trace(_Parts(), _Straight(), np.zeros(SHAPE, np.uint8), ENDS)
    assert len(traces) == 1
    assert traces[0].points_px[0] == pytest.approx(ENDS[1].position_px)


def _straight(x_from, x_to):
    line = np.column_stack([np.linspace(x_from, x_to, 50), np.full(50, 200.0)])
    return Trace(line, TraceEnd.ENDPOINT, 1.0)


def test_sgtm_takes_the_knot_that_its_trace_comes_to_first():
    far = Tangle(np.array([300.0, 210.0]), 30.0, 0.9)
    near = Tangle(np.array([800.0, 190.0]), 40.0, 0.6)
    aside = Tangle(np.array([500.0, 600.0]), 40.0, 0.99)
    met = first_met(_straight(900.0, 100.0), [far, near, aside])
    assert met is not None
    tangle, (low, high) = met
    assert tangle is near
    # Within the circle the trace runs over a chord of 2 sqrt(40^2 - 10^2) px.
    assert (high - low) * 800.0 == pytest.approx(2.0 * np.sqrt(40.0**2 - 10.0**2), abs=4.0)
    assert first_met(_straight(900.0, 100.0), [aside]) is None


def test_sgtm_says_where_a_dense_place_lies_on_its_trace():
    drawing = overhand()
    image = render(drawing, np.random.default_rng(5))
    tangle = Tangle(np.array([400.0, 380.0]), 130.0, 0.8)
    parts = GreyImageVision()
    seen = Sgtm2(parts, AnalyticTracer(), lambda _: [tangle]).scene(image)
    assert len(seen.knots) == 1
    assert seen.knotted_probability == 0.8
    first_px = seen.knots[0].first_undercrossing_px
    assert np.linalg.norm(first_px - tangle.centre_px) == pytest.approx(130.0, abs=6.0)


class TestGreedyTracer:
    @pytest.fixture(scope="class")
    def tracer(self):
        pytest.importorskip("torch")
        from perception.cable.baselines.greedy_tracer import GreedyTracer
        from perception.models.store import FOLDER

        return GreedyTracer(FOLDER / "tracer_v3")

    def _traced(self, tracer, drawing, start, ends=()):
        image = render(drawing, np.random.default_rng(6), connectors=False)
        return tracer.trace(image, drawing.points_px[start], ends)

    def test_follows_a_knot_to_the_other_end(self, tracer):
        drawing = overhand()
        line = drawing.points_px
        end = Endpoint(line[-1], np.array([1.0, 0.0]), 1.0)
        trace = self._traced(tracer, drawing, slice(0, 12, 3), (end,))
        assert trace is not None
        assert trace.end is TraceEnd.ENDPOINT
        assert followed_share(line[:-6], trace.points_px) == 1.0

    def test_stops_at_the_border_where_cable_leaves_the_view(self, tracer):
        way = np.linspace([-40.0, 300.0, 0.0], [1070.0, 420.0, 0.0], 300)
        way[:, 1] += 60.0 * np.sin(way[:, 0] / 120.0)
        drawing = Drawing(evenly(way))
        trace = self._traced(tracer, drawing, slice(60, 80, 3))
        assert trace is not None
        assert trace.end is TraceEnd.EDGE
        assert trace.points_px[-1, 0] > SHAPE[1] * (1.0 - 60.0 / 1032.0)

    def test_stops_when_it_goes_round_again(self, tracer):
        turn = np.linspace(0.0, 2.0 * np.pi, 300)
        ring = np.column_stack([500 + 160 * np.cos(turn), 380 + 160 * np.sin(turn), 0 * turn])
        trace = self._traced(tracer, Drawing(evenly(ring)), slice(0, 12, 3))
        assert trace is not None
        assert trace.end is TraceEnd.RETRACE
        length = np.linalg.norm(np.diff(trace.points_px, axis=0), axis=1).sum()
        assert length < 2.5 * 2.0 * np.pi * 160.0
