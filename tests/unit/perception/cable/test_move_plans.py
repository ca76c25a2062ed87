"""Plans for undoing cables: they end without crossings, honestly, and for little."""

from dataclasses import replace

import numpy as np
import pytest

from perception.cable.planning import MoveKind, MoveRules, PlanFailure, PlannerConfig, plan_moves
from perception.cable.planning.open_diagram import open_diagram
from perception.cable.topology import Knottedness, Strand, curve_crossings
from perception.cable.topology.certificate import certify
from perception.cable.topology.checker import replay
from simulation.cable.knots import TEMPLATES, fake_overs

ANYWHERE = PlannerConfig(least_room=0.0)


def _tied(name, size_px=200.0, tail_px=180.0):
    """Return a knot of the templates with straight tails, seen in pixels."""
    template = TEMPLATES[name]
    curve = template.curve_m(size_px, 3.0)
    tails = []
    for end, inner in ((curve[0], curve[4]), (curve[-1], curve[-5])):
        unit = (end - inner) / np.linalg.norm(end - inner)
        tails.append(end + np.arange(3.0, tail_px, 3.0)[:, None] * unit)
    points = np.vstack([tails[0][::-1], curve, tails[1]])
    return _laid(curve_crossings(np.c_[points, np.zeros(len(points))]), template)


def _laid(strand, template):
    """Return a strand along a template's curve with the template's over and under."""
    on_top = template.first_over(strand.crossings)
    tied = (replace(c, first_over=o) for c, o in zip(strand.crossings, on_top, strict=True))
    return replace(strand, crossings=tuple(tied))


def _in_series(first, second):
    """Return two strands as one, the second where the first one ends."""
    offset = first.points[-1] - second.points[0] + (3.0, 0.0)
    count = len(first.points)
    moved = (replace(c, first=c.first + count, second=c.second + count) for c in second.crossings)
    points = np.vstack([first.points, second.points + offset])
    return Strand(points, (*first.crossings, *moved))


def _random_strands(seed, count, corners=9):
    rng = np.random.default_rng(seed)
    curves = (rng.normal(size=(corners, 3)) * (150.0, 150.0, 1.0) for _ in range(count))
    return [curve_crossings(nodes) for nodes in curves]


def _is_proved_unknot(diagram):
    closed = diagram.closed()
    verdict, certificate = certify(closed)
    return (
        verdict.state is Knottedness.UNKNOT
        and replay(closed, certificate).state is Knottedness.UNKNOT
    )


def _assert_leads_down(plan):
    counts = [len(plan.seen), *(len(step.predicted) for step in plan.steps)]
    assert counts == sorted(counts, reverse=True)
    assert plan.failure is None


@pytest.mark.parametrize("name", sorted(TEMPLATES))
def test_every_knot_is_undone_with_a_proof(name):
    strand = _tied(name)
    assert not _is_proved_unknot(open_diagram(strand))
    plan = plan_moves(strand, ANYWHERE)
    _assert_leads_down(plan)
    assert any(step.kind is MoveKind.DILATE for step in plan.steps)
    assert len(plan.steps[-1].predicted) == 0
    sooner = plan_moves(strand, replace(ANYWHERE, goal="unknotted"))
    _assert_leads_down(sooner)
    assert _is_proved_unknot(sooner.steps[-1].predicted)
    assert sooner.cost <= plan.cost


def test_knots_in_series_are_undone_one_after_the_other():
    strand = _in_series(_tied("figure_8"), _tied("overhand"))
    assert open_diagram(strand).is_planar()
    plan = plan_moves(strand, ANYWHERE)
    _assert_leads_down(plan)
    assert [step.kind for step in plan.steps].count(MoveKind.DILATE) == 2
    assert len(plan.steps[-1].predicted) == 0


def test_random_cables_are_undone_by_no_more_moves_than_their_certificate_has():
    unknots = 0
    for strand in _random_strands(0, 60):
        plan = plan_moves(strand, ANYWHERE)
        _assert_leads_down(plan)
        assert not plan.steps or len(plan.steps[-1].predicted) == 0
        verdict, certificate = certify(plan.seen.closed())
        if verdict.state is Knottedness.UNKNOT:
            assert len(plan.steps) <= len(certificate.steps)
            assert not any(step.kind is MoveKind.DILATE for step in plan.steps)
            unknots += 1
    assert unknots > 30


@pytest.mark.parametrize("name", sorted(TEMPLATES))
def test_what_only_looks_like_a_knot_is_undone_without_moving_an_end(name):
    inside = replace(ANYWHERE, rules=MoveRules(free_ends=(False, False)))
    strand = _tied(name)
    assert plan_moves(strand, inside).failure is PlanFailure.ENDS_FIXED
    for overs in fake_overs(TEMPLATES[name])[:4]:
        fake = _laid(strand, replace(TEMPLATES[name], over=overs))
        plan = plan_moves(fake, inside)
        _assert_leads_down(plan)
        assert len(plan.steps[-1].predicted) == 0
        assert all(step.end is None for step in plan.steps)
        assert plan_moves(fake, replace(ANYWHERE, goal="unknotted")).steps == ()
        # With an end to move it takes no longer than the proof.
        _, certificate = certify(plan.seen.closed())
        assert len(plan_moves(fake, ANYWHERE).steps) <= len(certificate.steps)


def test_a_cable_costs_as_much_from_its_other_end():
    for name in sorted(TEMPLATES):
        strand = _tied(name)
        last = len(strand.points) - 1
        turned = tuple(
            replace(
                c,
                first=last - c.second,
                second=last - c.first,
                turn=-c.turn,
                first_over=not c.first_over,
            )
            for c in strand.crossings
        )
        backwards = Strand(strand.points[::-1], turned)
        plans = [plan_moves(each, ANYWHERE) for each in (strand, backwards)]
        assert plans[0].cost == pytest.approx(plans[1].cost, rel=0.02)
        assert plans[0].seen.backwards() == plans[1].seen


def test_cage_and_pinch_lie_on_both_strands_of_the_loop():
    strand = _tied("overhand")
    (step,) = plan_moves(strand, replace(ANYWHERE, goal="unknotted")).steps
    cage, pinch = step.grasps
    assert (cage.role, pinch.role) == ("cage", "pinch")
    for grasp in step.grasps:
        assert np.linalg.norm(strand.points - grasp.point, axis=1).min() < 3.0
        assert np.linalg.norm(grasp.direction) == pytest.approx(1.0)
        assert grasp.room == 1.0
    # They move apart.
    before, after = pinch.point - cage.point, pinch.to - cage.to
    assert np.linalg.norm(after) > np.linalg.norm(before)


def test_a_straight_cable_needs_nothing():
    plan = plan_moves(Strand(np.array([[0.0, 0.0], [100.0, 0.0], [200.0, 10.0]]), ()))
    assert (plan.steps, plan.failure, plan.cost) == ((), None, 0.0)


def test_failures_say_why():
    strand = _tied("bowline")
    first, *others = strand.crossings
    wrong = replace(strand, crossings=(replace(first, turn=-first.turn), *others))
    assert plan_moves(wrong).failure is PlanFailure.NOT_PLANAR
    assert plan_moves(strand, replace(ANYWHERE, states=1)).failure is PlanFailure.BUDGET
    tight = _tied("bowline", size_px=20.0, tail_px=4.0)
    assert plan_moves(tight).failure is PlanFailure.NO_ROOM


def test_the_same_strand_gives_the_same_plan():
    strand = _tied("linked_overhand")
    first, second = (plan_moves(strand, ANYWHERE) for _ in range(2))
    assert [s.kind for s in first.steps] == [s.kind for s in second.steps]
    assert first.cost == second.cost
    for one, other in zip(first.steps, second.steps, strict=True):
        assert all(
            np.array_equal(a.point, b.point) for a, b in zip(one.grasps, other.grasps, strict=True)
        )
