"""Links: invariants of known ones, unlinked curves that are told by moves, traced cables."""

import numpy as np
import pytest
from synthetic_cable import WIDTH_PX

from perception.cable.crossings import decide, find_sites
from perception.cable.linking import classify_cables, link_of
from perception.cable.topology.jones import jones_polynomial
from perception.cable.topology.links import (
    Link,
    Linkedness,
    LinkProof,
    bracket_far_apart,
    classify_link,
    lies_over,
    link_bracket,
    link_reduction,
    linking_number,
)
from perception.cable.topology.polynomial import Laurent
from perception.cable.types import Trace, TraceEnd


def closed_braid_link(letters, strands):
    """Two curves that a braid closes to; the first one holds strand 1."""
    curves, left = [], set(range(1, strands + 1))
    while left:
        at = start = min(left)
        curve = []
        while True:
            left.discard(at)
            for number, letter in enumerate(letters):
                if at in (abs(letter), abs(letter) + 1):
                    on_left = at == abs(letter)
                    curve.append((number, on_left == (letter > 0)))
                    at = abs(letter) + 1 if on_left else abs(letter)
            if at == start:
                break
        curves.append(tuple(curve))
    return Link(tuple(curves), tuple(1 if letter > 0 else -1 for letter in letters))


HOPF = closed_braid_link((1, 1), 2)
WHITEHEAD = closed_braid_link((1, -2, 1, -2, -2), 3)


def test_the_hopf_link_is_linked_once():
    for link, number in ((HOPF, 1), (closed_braid_link((-1, -1), 2), -1)):
        verdict = classify_link(link)
        assert (verdict.state, verdict.proof) == (Linkedness.LINKED, LinkProof.LINKING_NUMBER)
        assert verdict.linking_number == number
    # V of the Hopf link is -t^(1/2) - t^(5/2) (V. Jones 1985), and t = A^-4.
    assert link_bracket(HOPF) == Laurent(-10, (-1, 0, 0, 0, 0, 0, 0, 0, -1))


def test_the_whitehead_link_is_told_by_its_jones_polynomial_alone():
    assert linking_number(WHITEHEAD) == 0
    verdict = classify_link(WHITEHEAD)
    assert (verdict.state, verdict.proof) == (Linkedness.LINKED, LinkProof.JONES)


def test_torus_links_wind_half_as_often_as_they_cross():
    for crossings in (2, 4, 6):
        assert linking_number(closed_braid_link((1,) * crossings, 2)) == crossings // 2


def test_curves_one_on_the_other_come_apart_by_moves():
    unlinked = closed_braid_link((1, -1), 2)
    verdict = classify_link(unlinked)
    assert (verdict.state, verdict.proof) == (Linkedness.UNLINKED, LinkProof.MOVES)
    assert lies_over(verdict.steps[-1].after if verdict.steps else unlinked)


def trace(nodes):
    return Trace(nodes[:, :2] * [1.0, -1.0], TraceEnd.ENDPOINT, 1.0)


def seen(cables):
    """Traces of curves in space, and their crossings as they are."""
    traces = tuple(trace(nodes) for nodes in cables)
    crossings = []
    for site in find_sites(traces, WIDTH_PX):
        heights = [
            np.interp(arc * _length(traces[k].points_px)[-1], _length(traces[k].points_px), z)
            for k, arc, z in zip(
                site.traces, site.arcs, [cables[k][:, 2] for k in site.traces], strict=True
            )
        ]
        crossings.append(decide(site, float(heights[0] > heights[1])))
    return traces, crossings


def _length(points):
    return np.r_[0.0, np.linalg.norm(np.diff(points, axis=0), axis=1).cumsum()]


def random_cable(rng, low):
    t = np.linspace(0.0, 1.0, 160)
    waves = rng.normal(size=(3, 4, 2))
    x, y = (
        sum(
            waves[k, axis, 0] * np.cos((k + 1) * 4.0 * t)
            + waves[k, axis, 1] * np.sin((k + 2) * 4 * t)
            for k in range(3)
        )
        for axis in (0, 1)
    )
    return np.c_[150.0 * x, 150.0 * y, low + t]


@pytest.mark.parametrize("seed", range(8))
def test_a_cable_that_is_laid_on_another_is_not_linked_with_it(seed):
    rng = np.random.default_rng(seed)
    lower, upper = random_cable(rng, 0.0), random_cable(rng, 2.0)
    traces, crossings = seen([lower, upper])
    verdict = classify_cables(traces, crossings)
    assert verdict.state is Linkedness.UNLINKED
    # Curves that climb are unknots, so that the whole bracket is that of two loops.
    link = link_of(traces, crossings)
    if link.shared():
        assert link_bracket(link) == bracket_far_apart(link)


def test_two_bights_hooked_into_each_other_are_linked():
    # Each cable is a U; one lies over, then under the other: what is pulled stays.
    u = np.array([[-200.0, 40.0], [60.0, 40.0], [80.0, 0.0], [60.0, -40.0], [-200.0, -40.0]])
    t = np.linspace(0.0, 4.0, 300)
    first = np.c_[np.interp(t, range(5), u[:, 0]), np.interp(t, range(5), u[:, 1]), 0.0 * t]
    second = first * [-1.0, 1.0, 1.0] + [0.0, 22.0, 0.0]
    traces = (trace(first), trace(second))
    sites = find_sites(traces, WIDTH_PX)
    assert len(sites) == 2
    hooked = [decide(site, float(k)) for k, site in enumerate(sites)]
    laid = [decide(site, 1.0) for site in sites]
    assert classify_cables(traces, hooked).state is Linkedness.LINKED
    assert classify_cables(traces, laid).state is Linkedness.UNLINKED


def test_moves_on_links_keep_bracket_and_linking_number():
    rng = np.random.default_rng(5)
    moved = 0
    for _ in range(30):
        letters = [int(letter) for letter in rng.choice([1, -1, 2, -2], size=11)]
        link = closed_braid_link(letters, 3)
        if len(link.curves) != 2:
            continue
        for step in link_reduction(link):
            moved += 1
            assert linking_number(step.after) == linking_number(link)
            if step.after.shared():
                assert link_bracket(step.after) == link_bracket(link)
    assert moved > 10


def test_one_curve_of_a_link_is_the_knot_that_it_is():
    link = closed_braid_link((1, 1, 1, 2, 2), 3)
    knots = {jones_polynomial(link.curve(which)) for which in (0, 1)}
    assert knots == {Laurent(0, (1,)), Laurent(1, (1, 0, 1, -1))}
