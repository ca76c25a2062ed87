import numpy as np
import pytest

from benchmarks.knot_cores import closed_diameter, knot_core
from benchmarks.knot_judging import Cause, Wrong, judged
from benchmarks.knot_scenes import (
    DIAMETERS_M,
    KNOTS,
    LENGTH_M,
    TIERS,
    KnotScene,
    drawn,
    is_as_meant,
    settled,
)
from benchmarks.knot_truth import (
    first_piece,
    first_undercrossings,
    is_knotted,
    is_unknotted,
    polynomial,
    visits_of,
)
from benchmarks.laying import WIDTH_M
from perception.cable.baselines.tusk import NOTHING_KNOWN
from perception.cable.knots import find_knots
from perception.cable.polyline import arc_lengths, point_at
from perception.cable.topology import Strand, curve_crossings
from perception.cable.topology.rule import uncancelled_intervals
from perception.cable.types import CableScene, Crossing, Trace, TraceEnd
from simulation.cable.knots import TEMPLATES

MIDDLE = np.array([90.0, 90.0])


@pytest.fixture(scope="module")
def scenes():
    return {tier: drawn(tier, number, seed=77) for number, tier in enumerate(TIERS)}


def _core_strand(core):
    flat = np.column_stack([core.points, np.zeros(len(core.points))])
    strand = curve_crossings(flat)
    order = np.argsort([arc for c in strand.crossings for arc in (c.first, c.second)])
    place = {int(visit): k for k, visit in enumerate(order)}
    crossings = tuple(
        type(c)(c.first, c.second, c.turn, core.over[place[2 * k]])
        for k, c in enumerate(strand.crossings)
    )
    return Strand(strand.points, crossings)


@pytest.mark.parametrize("knot", KNOTS)
def test_cores_have_their_size_and_their_knot(knot):
    rng = np.random.default_rng(5)
    for low, high in DIAMETERS_M.values():
        diameter = rng.uniform(low, high) / WIDTH_M
        core = knot_core(rng, knot, diameter, MIDDLE, tied=True)
        assert closed_diameter(core.points) == pytest.approx(diameter, rel=0.1, abs=2.0)
    assert polynomial(_core_strand(core)) == polynomial(TEMPLATES[knot].strand())


@pytest.mark.parametrize("knot", KNOTS)
def test_untied_cores_are_proved_so_and_look_like_knots(knot):
    rng = np.random.default_rng(6)
    for _ in range(5):
        strand = _core_strand(knot_core(rng, knot, 30.0, MIDDLE, tied=False))
        assert is_unknotted(strand)
        assert uncancelled_intervals(visits_of(strand)) or uncancelled_intervals(
            visits_of(_mirrored(strand))
        )


def _mirrored(strand):
    crossings = tuple(
        type(c)(c.first, c.second, c.turn, not c.first_over) for c in strand.crossings
    )
    return Strand(strand.points, crossings)


def test_an_overhand_knot_begins_where_the_cable_first_goes_under():
    strand = TEMPLATES["overhand"].strand()
    visits = visits_of(strand)
    assert [visit.over for visit in visits] == [True, False] * 3
    # What leads over the knot can be taken off; what lies below is needed.
    assert first_piece(strand) == (visits[1].arc, visits[5].arc)


@pytest.mark.parametrize("knot", KNOTS)
def test_the_first_piece_is_the_shortest_one(knot):
    strand = TEMPLATES[knot].strand()
    piece = first_piece(strand)
    assert piece is not None
    visits = visits_of(strand)
    begin = next(visit for visit in visits if visit.arc == piece[0])
    end = next(visit for visit in visits if visit.arc == piece[1])
    # Whatever begins or ends on top could be left out.
    assert not begin.over
    assert not end.over


@pytest.mark.parametrize("tier", TIERS)
def test_scenes_are_what_they_are_meant_to_be(scenes, tier):
    scene = scenes[tier]
    assert is_as_meant(scene)
    strand = curve_crossings(scene.nodes_px)
    assert is_knotted(strand) == scene.is_knotted
    assert is_unknotted(strand) != scene.is_knotted
    length = arc_lengths(scene.nodes_px[:, :2])[-1] / scene.width_px * WIDTH_M
    assert length == pytest.approx(LENGTH_M, rel=0.06)
    first, last = (int(node) for node in scene.tied)
    diameter = closed_diameter(scene.nodes_px[first : last + 1, :2]) / scene.width_px
    low, high = np.array(DIAMETERS_M[tier]) / WIDTH_M
    # Strands that would lie in each other push each other aside.
    assert 0.9 * low - 2.0 < diameter < 1.1 * high + 3.0
    size = np.array(scene.image.shape[::-1])
    assert ((scene.nodes_px[:, :2] > 0.0) & (scene.nodes_px[:, :2] < size)).all()


@pytest.mark.parametrize("tier", TIERS)
def test_first_knots_begin_below_seen_from_either_end(scenes, tier):
    scene = scenes[tier]
    for nodes in (scene.nodes_px, scene.nodes_px[::-1]):
        found = scene.undercrossings_from(nodes[0, :2])
        assert bool(len(found)) == scene.is_knotted
        index = np.arange(len(nodes), dtype=float)
        below = [
            [np.interp(visit.arc, index, nodes[:, axis]) for axis in (0, 1)]
            for visit in visits_of(curve_crossings(nodes))
            if not visit.over
        ]
        for place in found:
            gaps = np.linalg.norm(np.array(below) - place, axis=1)
            assert gaps.min() < 0.1 * scene.width_px


def test_a_scene_is_the_same_for_the_same_seed(scenes):
    again = drawn("A2", 1, seed=77)
    assert np.array_equal(again.image, scenes["A2"].image)
    assert np.array_equal(again.nodes_px, scenes["A2"].nodes_px)
    assert not np.array_equal(drawn("A2", 1, seed=78).nodes_px, again.nodes_px)


def test_a_loop_on_the_tail_does_not_move_the_knot(scenes):
    scene = scenes["A2"]
    first, last = scene.tied
    low, high = int(first) - 2, int(last) + 3
    whole = first_undercrossings(scene.nodes_px, scene.tied)
    alone = first_undercrossings(scene.nodes_px[low:high], (first - low, last - low))
    assert alone == pytest.approx(whole)


def _seen(scene: KnotScene, *, flipped: int | None = None, traced: bool = True) -> CableScene:
    """What perfect perception says, but for one crossing."""
    if not traced:
        return CableScene((), (), (), (), NOTHING_KNOWN, 0.0)
    line = scene.nodes_px[:, :2]
    arcs, index = arc_lengths(line), np.arange(len(line), dtype=float)
    trace = Trace(line, TraceEnd.ENDPOINT, 1.0)
    crossings = []
    for number, crossing in enumerate(curve_crossings(scene.nodes_px).crossings):
        at = np.interp([crossing.first, crossing.second], index, arcs)
        over, under = at if crossing.first_over != (number == flipped) else at[::-1]
        place = point_at(line, arcs, float(at[0]))
        crossings.append(Crossing(place, 0, over / arcs[-1], 0, under / arcs[-1], 0.99))
    knots = find_knots([trace], crossings)
    return CableScene((trace,), (), tuple(crossings), knots, float(bool(knots)), 0.0)


@pytest.mark.parametrize("tier", TIERS)
def test_who_sees_everything_is_right(scenes, tier):
    assert judged(scenes[tier], _seen(scenes[tier])) is None


def test_who_sees_nothing_is_wrong_whatever_there_is(scenes):
    for tier, wrong in (("A1", Wrong.MISSED), ("A3", Wrong.UNSEEN)):
        failure = judged(scenes[tier], _seen(scenes[tier], traced=False))
        assert failure is not None
        assert (failure.wrong, failure.cause) == (wrong, Cause.ENDS)


def test_a_crossing_that_was_read_wrongly_is_named_as_the_cause(scenes):
    scene = scenes["A1"]
    count = len(curve_crossings(scene.nodes_px).crossings)
    failures = [judged(scene, _seen(scene, flipped=k)) for k in range(count)]
    found = [failure for failure in failures if failure is not None]
    assert found
    assert {failure.cause for failure in found} == {Cause.CROSSING}


def test_a_trace_that_leaves_cable_out_is_named_as_the_cause(scenes):
    scene = scenes["A1"]
    line = scene.nodes_px[:, :2]
    trace = Trace(np.vstack([line[:60], line[-60:]]), TraceEnd.ENDPOINT, 1.0)
    failure = judged(scene, CableScene((trace,), (), (), (), 0.0, 0.0))
    assert failure is not None
    assert (failure.wrong, failure.cause) == (Wrong.MISSED, Cause.TRACING)


def test_half_a_cable_without_a_knot_says_nothing(scenes):
    seen = _seen(scenes["A3"])
    half = Trace(seen.traces[0].points_px[:400], TraceEnd.ENDPOINT, 1.0)
    failure = judged(scenes["A3"], CableScene((half,), (), (), (), 0.0, 0.0))
    assert failure is not None
    assert (failure.wrong, failure.cause) == (Wrong.UNSEEN, Cause.TRACING)


def test_a_settled_cable_is_still_tied():
    scene = settled("A2", 0, seed=78)
    assert is_as_meant(scene)
    assert scene.undercrossings_from(scene.nodes_px[0, :2]).shape[1] == 2
    length = arc_lengths(scene.nodes_px[:, :2])[-1] / scene.width_px * WIDTH_M
    assert length == pytest.approx(LENGTH_M, rel=0.1)
