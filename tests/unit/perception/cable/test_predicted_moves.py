"""Moves of a robot on a cable: what is predicted of each holds for the curve itself."""

from dataclasses import replace

import numpy as np
import pytest

from perception.cable.planning import Agreement, MoveKind, MoveRules, OpenDiagram, agreement, agrees
from perception.cable.planning.finder import MoveFinder
from perception.cable.planning.laying import Faces, laid, stretches
from perception.cable.planning.open_diagram import open_diagram
from perception.cable.topology import close_over, curve_crossings
from perception.cable.topology.alexander import alexander_polynomial


def _curves(seed, count, corners=10):
    rng = np.random.default_rng(seed)
    return [rng.normal(size=(corners, 3)) for _ in range(count)]


def _diagrams(seed, count, corners=10):
    found = [open_diagram(curve_crossings(nodes)) for nodes in _curves(seed, count, corners)]
    return [diagram for diagram in found if diagram.visits]


def _cut(nodes, begin, end):
    """Return the piece of a curve between two arc positions of its plan view."""
    arcs = np.r_[0.0, np.linalg.norm(np.diff(nodes[:, :2], axis=0), axis=1).cumsum()]
    at = np.array([begin, end]) * arcs[-1]
    ends = np.stack([np.interp(at, arcs, nodes[:, axis]) for axis in range(3)], axis=1)
    inside = nodes[(arcs > at[0]) & (arcs < at[1])]
    return np.vstack([ends[:1], inside, ends[1:]])


def _knot(diagram):
    return alexander_polynomial(diagram.closed())


def test_open_diagrams_lie_in_the_plane_and_close_to_the_same_knot():
    for nodes in _curves(0, 60):
        strand = curve_crossings(nodes)
        diagram = open_diagram(strand)
        assert diagram.is_planar()
        assert diagram.closed().is_planar()
        assert _knot(diagram) == alexander_polynomial(close_over(strand))


def test_following_a_cable_backwards_twice_is_following_it():
    for nodes in _curves(1, 30):
        diagram = open_diagram(curve_crossings(nodes))
        assert diagram.backwards().backwards() == diagram
        assert open_diagram(curve_crossings(nodes[::-1])) == diagram.backwards()


@pytest.mark.parametrize("end", ["start", "finish"])
def test_an_end_drawn_out_leaves_the_diagram_of_the_curve_cut_there(end):
    checked = 0
    for nodes in _curves(2, 60):
        diagram = open_diagram(curve_crossings(nodes))
        for move in MoveFinder().moves(diagram):
            if move.end != end:
                continue
            stays = (
                diagram.span(move.passed)
                if end == "start"
                else diagram.span(len(diagram.visits) - move.passed)
            )
            middle = sum(stays) / 2.0
            left = _cut(nodes, *((middle, 1.0) if end == "start" else (0.0, middle)))
            assert move.predicted == open_diagram(curve_crossings(left))
            checked += 1
    assert checked > 200


def test_no_move_but_a_dilation_changes_the_knot():
    kinds = set()
    for diagram in _diagrams(3, 60, corners=11):
        knot = _knot(diagram)
        for move in MoveFinder().moves(diagram):
            assert move.predicted.is_planar()
            assert len(move.predicted) <= len(diagram)
            assert (_knot(move.predicted) == knot) == (move.kind is not MoveKind.DILATE)
            kinds.add(move.kind)
    assert kinds == set(MoveKind)


def test_a_run_laid_elsewhere_leaves_all_other_crossings_alone():
    for diagram in _diagrams(4, 40):
        faces = Faces(diagram)
        for run in stretches(diagram):
            way = faces.way(run)
            if way is None:
                continue
            after = laid(diagram, run, way)
            assert len(after) == len(diagram) - run.length + len(way)
            lifted = frozenset(diagram.visits[run.first : run.last + 1])
            begin, end = diagram.span(run.first)[0], diagram.span(run.last + 1)[1]
            fresh = frozenset(
                crossing
                for crossing, arc in zip(after.visits, after.arcs, strict=True)
                if begin < arc < end
            )
            assert diagram.without(lifted) == after.without(fresh)
            assert list(after.arcs) == sorted(after.arcs)


def test_ends_that_are_fixed_stay_where_they_are():
    fixed = MoveFinder(MoveRules(free_ends=(False, False)))
    for diagram in _diagrams(5, 30):
        for move in fixed.moves(diagram):
            assert move.end is None
            assert _knot(move.predicted) == _knot(diagram)


def test_there_is_always_a_move_that_undoes_a_crossing_while_an_end_is_free():
    for free_ends in ((True, False), (False, True)):
        finder = MoveFinder(MoveRules(free_ends=free_ends))
        for diagram in _diagrams(6, 40):
            assert min(len(move.predicted) for move in finder.moves(diagram)) < len(diagram)


def _with_twist(diagram, edge, sign):
    """Return the diagram with a loop put into one of its edges."""
    begin, end = diagram.span(edge)
    fresh, signs = len(diagram), (*diagram.signs, sign)
    arcs = tuple(begin + (end - begin) * share for share in (0.3, 0.6))
    return OpenDiagram(
        _numbered((*diagram.visits[:edge], fresh, fresh, *diagram.visits[edge:])),
        (*diagram.over[:edge], True, False, *diagram.over[edge:]),
        _in_order((*diagram.visits[:edge], fresh, fresh, *diagram.visits[edge:]), signs),
        (*diagram.arcs[:edge], *arcs, *diagram.arcs[edge:]),
    )


def _numbered(visits):
    names = {}
    return tuple(names.setdefault(visit, len(names)) for visit in visits)


def _in_order(visits, signs):
    return tuple(signs[visit] for visit in dict.fromkeys(visits))


def test_twists_do_not_count_against_a_prediction():
    rng = np.random.default_rng(7)
    for diagram in _diagrams(7, 40, corners=8):
        edge, sign = int(rng.integers(len(diagram.visits) + 1)), int(rng.choice([-1, 1]))
        seen = _with_twist(diagram, edge, sign)
        assert seen.is_planar()
        assert agreement(diagram, seen) in (Agreement.SAME, Agreement.BUT_FOR_TWISTS)
        assert agrees(diagram, seen)
        assert agrees(diagram, seen.backwards())


def test_another_knot_is_not_what_was_predicted():
    t = np.linspace(0.0, 2.0 * np.pi, 200)[:-1]
    ring = 2.0 + np.cos(3.0 * t)
    nodes = np.c_[ring * np.cos(2.0 * t), ring * np.sin(2.0 * t), np.sin(3.0 * t)]
    knot = open_diagram(curve_crossings(nodes))
    lying = open_diagram(curve_crossings(np.c_[nodes[:, :2], np.linspace(0.0, 1.0, len(nodes))]))
    mirror = open_diagram(curve_crossings(nodes * (1.0, 1.0, -1.0)))
    assert agreement(knot, lying) is Agreement.DIFFERENT
    assert not agrees(knot, mirror)
    assert agreement(knot, mirror) is Agreement.SAME_KNOT
    assert agreement(knot, replace(knot)) is Agreement.SAME
