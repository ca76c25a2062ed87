import numpy as np
import pytest

from perception.training import contact, curves
from perception.training.scenes import SceneConfig, make_scene

SMALL = SceneConfig(extent=24.0, narrowest_px=5.0, widest_px=7.0)


@pytest.mark.parametrize("family", sorted(curves.FAMILIES))
def test_curves_have_even_steps(family):
    curve = curves.FAMILIES[family](np.random.default_rng(4), 40.0)
    steps = np.linalg.norm(np.diff(curve, axis=0), axis=1)
    assert len(curve) > 20
    assert steps == pytest.approx(np.full(len(steps), curves.SPACING), rel=0.2)


def test_a_hook_goes_round_a_place_of_the_other_cable():
    rng = np.random.default_rng(8)
    found = []
    for _ in range(20):
        line = curves.settled_curve(rng, 40.0)
        both = np.vstack([line, hook := curves.hooked(rng, line)])
        cable = np.repeat([0, 1], [len(line), len(hook)])
        places = contact.crossings(both, cable)
        found.append(((places < len(line)).sum(axis=1) == 1).sum())
    # A bight passes under or over the other strand at both its legs.
    assert np.mean(np.array(found) >= 2) > 0.8


def test_a_hairpin_is_in_view():
    rng = np.random.default_rng(6)
    line = curves.FAMILIES["hairpin"](rng, 40.0)
    # Eight widths of cable that end within four of where they began.
    folded = np.linalg.norm(line[16:] - line[:-16], axis=1) < 4.0
    bends = line[8:-8][folded]
    assert ((bends > 0.0) & (bends < 40.0)).all(axis=1).any()


@pytest.mark.parametrize("near", [curves.beside, curves.touching])
def test_a_curve_beside_another_comes_near_it(near):
    rng = np.random.default_rng(5)
    line = curves.settled_curve(rng, 40.0)
    for _ in range(5):
        gaps = np.linalg.norm(near(rng, line)[:, None] - line[None], axis=2)
        assert (gaps.min(axis=1) < 2.0).sum() > 8


def test_one_seed_gives_one_scene():
    first, second = (make_scene(np.random.default_rng([7, 3]), SMALL) for _ in range(2))
    assert np.array_equal(first.image, second.image)
    assert first.crossings == second.crossings


def test_truth_says_which_strand_is_higher():
    found = 0
    for seed in range(6):
        scene = make_scene(np.random.default_rng(seed), SMALL)
        for crossing in scene.crossings:
            over, under = (
                np.interp(
                    node, np.arange(len(scene.cables[cable].heights)), scene.cables[cable].heights
                )
                for cable, node in (crossing.over, crossing.under)
            )
            assert over > under
            found += 1
    assert found > 5


def test_settling_parts_balls_that_overlap():
    line = np.column_stack([np.arange(0.0, 20.0, 0.5), np.zeros(40), np.full(40, 0.5)])
    other = line[:, [1, 0, 2]] + np.array([10.0, -10.0, 0.2])
    nodes, cable = np.vstack([line, other]), np.repeat([0, 1], 40)
    pairs = contact.near_pairs(np.ascontiguousarray(nodes[:, :2]), cable)
    before = np.linalg.norm(nodes[pairs[:, 0]] - nodes[pairs[:, 1]], axis=1).min()
    contact.settle(nodes, cable, pairs, 60, np.ones(2))
    after = np.linalg.norm(nodes[pairs[:, 0]] - nodes[pairs[:, 1]], axis=1).min()
    assert before < 0.4
    assert after > 0.8
    assert nodes[:, 2].min() >= 0.5 - 1e-9


def test_crossings_of_two_lines():
    line = np.column_stack([np.arange(0.0, 10.0, 0.5), np.zeros(20)])
    other = line[:, ::-1] + np.array([4.75, -5.1])
    places = contact.crossings(np.vstack([line, other]), np.repeat([0, 1], 20))
    assert places == pytest.approx(np.array([[9.5, 20 + 10.2]]))
