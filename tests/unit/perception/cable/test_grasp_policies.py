"""Both searches for cage and pinch: where they hold knots, and what they say where they cannot."""

import pytest
from exact_sight import seen_exactly
from synthetic_cable import figure_8, overhand

from perception.cable.grasp_points import GraspConfig, GraspFlaw, held_strand
from perception.cable.grasp_tusk import ACCEPTED, APART, CROSSING, TuskPolicy
from perception.cable.knots import choose_grasps, find_knots, grasp_policy, knot_intervals

WIDTH_PX = 6.0
KNOTS = {"overhand": overhand, "figure_8": figure_8}


def _grasps(drawing, config, scale=1.0, width_px=WIDTH_PX):
    trace, crossings, pixels = seen_exactly(drawing, scale, width_px)
    (interval,) = knot_intervals(trace, 0, crossings)
    strand = held_strand((trace,), 0, crossings)
    return strand, choose_grasps(grasp_policy(config, pixels), strand, interval), pixels


@pytest.mark.parametrize("policy", ["room", "tusk"])
@pytest.mark.parametrize("knot", sorted(KNOTS))
def test_a_loose_knot_is_held_at_two_lonely_places(policy, knot):
    strand, grasps, _ = _grasps(KNOTS[knot](), GraspConfig(policy=policy))
    assert grasps.flaw is None
    assert strand.apart_px(grasps.cage_px, grasps.pinch_px) >= APART * WIDTH_PX
    for at_px in (grasps.cage_px, grasps.pinch_px):
        assert strand.to_crossing_px(at_px) > CROSSING * WIDTH_PX


@pytest.mark.parametrize("policy", ["room", "tusk"])
def test_a_tight_knot_is_held_somewhere_but_said_to_be_crowded(policy):
    config = GraspConfig(policy=policy, farther_px=20.0)
    strand, grasps, _ = _grasps(overhand(), config, scale=0.1)
    assert isinstance(grasps.flaw, GraspFlaw)
    assert 0.0 <= grasps.cage_px <= strand.length_px
    assert 0.0 <= grasps.pinch_px <= strand.length_px


def test_what_the_thesis_accepts_is_below_its_threshold():
    strand, grasps, pixels = _grasps(overhand(), GraspConfig(policy="tusk"))
    policy = TuskPolicy(pixels)
    assert policy.graspability(strand, grasps.cage_px) <= ACCEPTED
    assert policy.graspability(strand, grasps.pinch_px) <= ACCEPTED
    worst = max(policy.graspability(strand, at) for at in strand.crossings_px)
    assert worst > ACCEPTED


def test_the_thesis_search_does_not_depend_on_the_size_of_the_image():
    plain, enlarged = (
        _grasps(figure_8(), GraspConfig(policy="tusk"), scale, scale * WIDTH_PX)[:2]
        for scale in (1.0, 2.0)
    )
    for name in ("cage_px", "pinch_px"):
        shares = [getattr(grasps, name) / strand.length_px for strand, grasps in (plain, enlarged)]
        # One step of the walk is about two widths.
        assert shares[0] == pytest.approx(shares[1], abs=2.5 * WIDTH_PX / plain[0].length_px)


def test_the_thesis_search_asks_for_what_is_cable():
    trace, crossings, pixels = seen_exactly(overhand())
    config = GraspConfig(policy="tusk")
    with pytest.raises(ValueError, match="policy 'tusk' counts pixels of cable; got none"):
        find_knots((trace,), crossings, config)
    assert find_knots((), (), config) == ()
    assert len(find_knots((trace,), crossings, config, pixels)) == 1
