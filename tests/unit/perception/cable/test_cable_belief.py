"""P(knotted): what is listed, how it adds up, and what it is pulled to."""

import itertools
import math

import numpy as np
import pytest
from synthetic_cable import Drawing, figure_8, laid_down, overhand

from perception.cable.belief import diagram_probability, knotted_probability
from perception.cable.crossings import decide, find_sites
from perception.cable.knots import find_knots, knot_intervals
from perception.cable.outcomes import likeliest_flips
from perception.cable.topology import curve_crossings
from perception.cable.types import Crossing, Trace, TraceEnd


def seen(drawing: Drawing, sure: float = 0.999) -> tuple[Trace, tuple[Crossing, ...]]:
    """The trace of a drawing, and its crossings as they are, all equally sure."""
    trace = Trace(drawing.points_px, TraceEnd.ENDPOINT, 1.0)
    sites = find_sites((trace,))
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
