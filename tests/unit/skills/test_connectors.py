"""Strands that lie across a connector: crossings that a trace does not show."""

from dataclasses import replace

import numpy as np
import pytest
from cell_fakes import finished, frame

from executive.core.work import InlineWorker
from perception.cable.belief import knotted_probability
from perception.cable.polyline import arc_lengths
from perception.cable.topology.curve import self_intersections
from perception.cable.types import Crossing, Endpoint, Trace, TraceEnd
from skills.cable.connectors import NOTHING_KNOWN, through_connectors
from skills.cable.find_knots import FindKnots


def loop_towards_its_end(gap_px, turn=1.0):
    """Return a trace that makes a loop and ends `gap_px` before the strand that it began with."""
    angle = np.linspace(0.0, 1.5 * np.pi, 120)
    circle = 100.0 * np.column_stack([np.sin(angle), turn * (1.0 - np.cos(angle))])
    lead = np.column_stack([np.linspace(-300.0, 0.0, 100)[:-1], np.zeros(99)])
    last = circle[-1] + np.arange(1, 200)[:, None] * (0.0, -turn)
    last = last[turn * last[:, 1] > gap_px]
    return Trace(np.vstack([lead, circle, last]) + 500.0, TraceEnd.ENDPOINT, 1.0)


@pytest.mark.parametrize("turn", [1.0, -1.0])
@pytest.mark.parametrize(("gap_px", "hidden"), [(3.0, 1), (30.0, 1), (60.0, 0)])
@pytest.mark.parametrize("backwards", [False, True])
def test_a_strand_across_a_connector_is_a_crossing_of_which_nothing_is_known(
    gap_px, hidden, turn, backwards
):
    trace = loop_towards_its_end(gap_px, turn)
    if backwards:
        trace = replace(trace, points_px=trace.points_px[::-1])
    whole, crossings = through_connectors(trace, (), ())
    assert len(crossings) == hidden
    assert (whole is trace) == (hidden == 0)
    for crossing in crossings:
        assert crossing.probability == NOTHING_KNOWN
        assert np.linalg.norm(crossing.position_px - [400.0, 500.0]) < 2.0


def test_the_way_that_an_end_points_counts_more_than_that_of_the_trace():
    trace = loop_towards_its_end(20.0)
    aside = Endpoint(trace.points_px[-1], np.array([1.0, 0.0]), 0.9)
    assert through_connectors(trace, (), (aside,))[1] == ()


def test_crossings_stay_where_they_are_on_the_cable():
    trace = loop_towards_its_end(20.0)
    seen = Crossing(trace.points_px[150], 0, 0.25, 0, 0.75, 0.9)
    whole, (moved, _) = through_connectors(trace, (seen,), ())

    def place(path, arc):
        arcs = arc_lengths(path.points_px)
        return [np.interp(arc * arcs[-1], arcs, path.points_px[:, k]) for k in (0, 1)]

    assert np.allclose(place(whole, moved.arc_over), place(trace, 0.25), atol=0.01)
    assert np.allclose(place(whole, moved.arc_under), place(trace, 0.75), atol=0.01)


class Beliefs:
    """A vision that carries beliefs, and finds no knots to hold."""

    def knots(self, image, traces, crossings):
        return ()

    def knotted_probability(self, traces, crossings):
        return knotted_probability(traces, crossings)


def overhand_whose_end_is_hidden():
    """Return an overhand knot whose trace ends 20 px before its last crossing, an undercrossing."""
    t = np.linspace(0.1, 2.0 * np.pi - 0.1, 800)
    path = 100.0 * np.column_stack([np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t)])
    first, second, _ = self_intersections(path)
    visits = sorted([*first, *second])
    over = {visit: number % 2 == 0 for number, visit in enumerate(visits)}
    end = int(visits[-1]) - int(20.0 / np.linalg.norm(path[-1] - path[-2]))
    trace = Trace(path[:end], TraceEnd.ENDPOINT, 1.0)
    arcs = arc_lengths(trace.points_px)
    share = {visit: float(np.interp(visit, np.arange(end), arcs) / arcs[-1]) for visit in visits}
    seen = [
        Crossing(path[int(a)], 0, share[a if over[a] else b], 0, share[b if over[a] else a], 1.0)
        for a, b in zip(first, second, strict=True)
        if b != visits[-1]
    ]
    return trace, tuple(seen)


def test_an_end_that_may_lie_under_a_strand_makes_a_sure_look_unsure():
    trace, crossings = overhand_whose_end_is_hidden()
    assert len(crossings) == 2
    inputs = {"frame": frame(), "trace": trace, "crossings": crossings}
    skill = FindKnots(Beliefs(), InlineWorker())
    plain, _ = finished(skill, inputs)
    doubting, _ = finished(skill, {**inputs, "doubt_connectors": True})
    assert plain.outputs["knotted_probability"] == pytest.approx(0.0, abs=1e-6)
    assert doubting.outputs["knotted_probability"] == pytest.approx(0.5, abs=1e-6)
