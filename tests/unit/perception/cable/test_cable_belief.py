"""P(knotted): what is listed, how it adds up, and what it is pulled to."""

import itertools
import math

import numpy as np
import pytest
from synthetic_cable import WIDTH_PX, Drawing, figure_8, laid_down, overhand

from perception.cable.belief import diagram_probability, knotted_probability, reading_of
from perception.cable.crossings import decide, find_sites
from perception.cable.knots import find_knots, knot_intervals, likeliest_together
from perception.cable.outcomes import likeliest_flips
from perception.cable.polyline import arc_lengths, point_at
from perception.cable.topology import curve_crossings
from perception.cable.types import Crossing, Trace, TraceEnd


def seen(drawing: Drawing, sure: float = 0.999) -> tuple[Trace, tuple[Crossing, ...]]:
    """The trace of a drawing, and its crossings as they are, all equally sure."""
    trace = Trace(drawing.points_px, TraceEnd.ENDPOINT, 1.0)
    sites = find_sites((trace,), WIDTH_PX)
    over = [crossing.first_over for crossing in curve_crossings(drawing.nodes).crossings]
    assert len(sites) == len(over)
    return trace, tuple(
        decide(site, sure if first_over else 1.0 - sure)
        for site, first_over in zip(sites, over, strict=True)
    )


def test_flips_come_with_falling_weight_and_cover_everything():
    probabilities = [0.9, 0.6, 0.75, 0.99, 0.5]
    listed = list(likeliest_flips(probabilities))
    weights = [weight for _, weight in listed]
    assert weights == sorted(weights, reverse=True)
    assert len({flips for flips, _ in listed}) == len(listed)
    assert sum(weights) == pytest.approx(1.0, abs=2e-3)
    for flips, weight in listed:
        exact = math.prod(1.0 - p if k in flips else p for k, p in enumerate(probabilities))
        assert weight == pytest.approx(exact)


@pytest.mark.parametrize("tie", [overhand, figure_8])
def test_sure_knots_are_sure(tie):
    trace, crossings = seen(tie())
    assert knotted_probability((trace,), crossings) > 0.97
    assert len(find_knots((trace,), crossings)) == 1


@pytest.mark.parametrize("tie", [overhand, figure_8])
def test_the_same_curve_laid_down_in_order_is_no_knot(tie):
    trace, crossings = seen(laid_down(tie()))
    assert knotted_probability((trace,), crossings) < 0.03
    assert find_knots((trace,), crossings) == ()


@pytest.mark.parametrize("seed", range(12))
def test_a_knot_is_found_where_one_is_believed_in(seed):
    rng = np.random.default_rng(seed)
    trace, crossings = seen(overhand() if seed % 2 else figure_8())
    unsure = [_turned(c, rng.uniform(0.5, 0.7), rng.random() < 0.5) for c in crossings]
    believed = diagram_probability(trace, 0, unsure) > 0.5
    assert bool(find_knots((trace,), unsure)) == believed


def _turned(crossing: Crossing, probability: float, flip: bool) -> Crossing:
    arcs = crossing.arc_over, crossing.arc_under
    over, under = arcs[::-1] if flip else arcs
    return Crossing(crossing.position_px, 0, over, 0, under, probability)


def test_the_likeliest_answers_one_by_one_need_not_be_likeliest_together():
    rng = np.random.default_rng(5)
    trace, crossings = seen(figure_8())
    changed = 0
    for _ in range(40):
        unsure = [_turned(c, rng.uniform(0.5, 0.6), rng.random() < 0.5) for c in crossings]
        together = likeliest_together(reading_of(trace, 0, unsure))
        changed += [c.arc_over for c in together] != [
            c.arc_over for c in sorted(unsure, key=lambda c: min(c.arc_over, c.arc_under))
        ]
    assert 0 < changed < 40


def test_one_open_crossing_of_an_overhand_leaves_one_half():
    trace, crossings = seen(overhand(), sure=1.0 - 1e-9)
    beliefs = []
    for k, crossing in enumerate(crossings):
        unsure = Crossing(crossing.position_px, 0, crossing.arc_over, 0, crossing.arc_under, 0.5)
        beliefs.append(diagram_probability(trace, 0, (*crossings[:k], unsure, *crossings[k + 1 :])))
    # The tails' own crossing does not matter; each of the knot's three does.
    assert sorted(round(belief, 6) for belief in beliefs) == [0.5, 0.5, 0.5, 1.0]


def test_belief_is_the_sum_over_all_combinations():
    trace, crossings = seen(figure_8(), sure=0.8)
    total = 0.0
    for flips in itertools.product((False, True), repeat=len(crossings)):
        exact = [
            Crossing(c.position_px, 0, c.arc_under, 0, c.arc_over, 1.0)
            if flip
            else Crossing(c.position_px, 0, c.arc_over, 0, c.arc_under, 1.0)
            for c, flip in zip(crossings, flips, strict=True)
        ]
        total += math.prod(0.2 if flip else 0.8 for flip in flips) * diagram_probability(
            trace, 0, exact
        )
    assert diagram_probability(trace, 0, crossings) == pytest.approx(total, abs=2e-3)


def test_unsure_and_unfinished_traces_pull_towards_one_half():
    trace, crossings = seen(overhand())
    sure = knotted_probability((trace,), crossings)
    unsure = Trace(trace.points_px, TraceEnd.ENDPOINT, 0.6)
    lost = Trace(trace.points_px, TraceEnd.LOST, 1.0)
    assert 0.5 < knotted_probability((unsure,), crossings) < sure
    assert 0.5 < knotted_probability((lost,), crossings) < sure
    assert knotted_probability((), ()) == 0.5


def test_mirrored_cables_are_knotted_alike():
    trace, crossings = seen(figure_8(), sure=0.9)
    mirrored = tuple(
        Crossing(c.position_px, 0, c.arc_under, 0, c.arc_over, c.probability) for c in crossings
    )
    assert diagram_probability(trace, 0, mirrored) == pytest.approx(
        diagram_probability(trace, 0, crossings)
    )


def test_knots_start_below_and_close_on_top_of_one_crossing():
    for tie in (overhand, figure_8):
        trace, crossings = seen(tie())
        ((begin, end),) = knot_intervals(trace, 0, crossings)
        assert any(c.arc_under == begin and c.arc_over == end for c in crossings)


def test_two_knots_in_series_are_two_knots():
    first = overhand((260.0, 220.0), 90.0).nodes
    second = overhand((260.0, 560.0), 90.0).nodes
    joined = np.vstack(
        [
            first,
            second[::-1]
            if np.hypot(*(second[-1] - first[-1])[:2]) < np.hypot(*(second[0] - first[-1])[:2])
            else second,
        ]
    )
    trace, crossings = seen(Drawing(joined))
    knots = find_knots((trace,), crossings)
    assert len(knots) == 2
    assert knots[0].interval[1] < knots[1].interval[0]


def test_a_noose_before_the_knot_is_no_knot():
    # A knot tied with a bight, ends on one side, comes undone; half of it alone does not.
    bight, knot = overhand((260.0, 220.0), 90.0).nodes, overhand((260.0, 560.0), 60.0).nodes
    aside = np.c_[-np.gradient(bight[:, 1]), np.gradient(bight[:, 0])]
    aside *= 8.0 / np.linalg.norm(aside, axis=1, keepdims=True)
    back = np.c_[bight[:, :2] + aside, bight[:, 2] - 0.1][::-1]
    noose, own = seen(Drawing(bight))
    assert len(find_knots((noose,), own)) == 1
    whole, crossings = seen(Drawing(np.vstack([bight, back, knot])))
    (found,) = find_knots((whole,), crossings)
    assert found.first_undercrossing_px[1] > 400.0


def test_crossings_of_a_small_knot_lie_on_the_trace_where_they_are():
    # Steps that cut corners must not shift what comes after them along the trace.
    drawing = overhand((300.0, 300.0), 9.0)
    trace = Trace(drawing.points_px, TraceEnd.ENDPOINT, 1.0)
    arcs = arc_lengths(trace.points_px)
    for site in find_sites((trace,), 4.0):
        for arc in site.arcs:
            there = point_at(trace.points_px, arcs, np.array([arc * arcs[-1]]))[0]
            assert np.linalg.norm(there - site.position_px) < 0.5
