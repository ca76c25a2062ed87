"""Spatial occupancy: the truth stays possible, and what could be seen does not."""

import numpy as np
import pytest
from shelf_search import drawn_scenes

from benchmarks.search_trials import Way, WaySearcher
from perception.shelf.casting import BoxCaster
from perception.shelf.hidden_poses import HiddenPoses, PoseBelief, PoseRules
from perception.shelf.rendering import ShelfRenderer
from perception.shelf.sightings import sightings
from perception.shelf.spatial import RunningMinimum, along_shelf, mask_occupancy
from perception.shelf.types import Box, Shelf
from simulation.shelf.cameras import front_camera
from simulation.shelf.scenes import Scene, SceneRules
from simulation.shelf.world import DepthNoise, ShelfWorld

CASES = [("pharmacy", SceneRules(15)), ("office", SceneRules(21)), ("kitchen", SceneRules(18, 0.0))]


def nearest_cell(poses, box):
    return int(np.abs(poses.places_m - [box.x_m, box.y_m]).max(axis=1).argmin())


@pytest.mark.parametrize(("name", "rules"), CASES)
def test_where_the_target_is_is_never_ruled_out(name, rules):
    for scene in drawn_scenes(name, rules, range(5)):
        searcher = WaySearcher(scene, Way())
        cell = nearest_cell(searcher.poses, searcher.world.boxes[scene.target])
        for _ in range(6):
            if searcher.shows():
                break
            left = searcher.belief.left.copy()
            searcher.look()
            view, seen = searcher.view, searcher.seen
            assert searcher.belief.left[cell]
            assert not (searcher.belief.left & ~left).any()
            move = searcher.policy.choose(
                searcher.occupancy(view, seen), view, seen, searcher.contacts.footprints
            )
            if move is None:
                break
            searcher.act(move)


def test_noise_does_not_rule_out_the_truth_either():
    for scene in drawn_scenes("pharmacy", SceneRules(15), range(5)):
        noise = DepthNoise(spread_m=0.002, lost_share=0.05)
        world = ShelfWorld(scene, np.random.default_rng(0), noise=noise)
        caster, size = BoxCaster(world.camera), world.boxes[scene.target].size_m
        poses = HiddenPoses(size, scene.shelf, caster, PoseRules(margin_m=0.015))
        view = world.look()
        seen = sightings(view, scene.shelf, {n: b.size_m for n, b in world.boxes.items()}, caster)
        assert poses.feasible(view, seen)[nearest_cell(poses, world.boxes[scene.target])]


def test_what_is_left_is_what_rendering_says_is_hidden():
    """A slow second way: put the target in a cell and count its pixels that would show."""
    scene = drawn_scenes("pharmacy", SceneRules(15), [3])[0]
    world = ShelfWorld(scene, np.random.default_rng(0))
    caster = BoxCaster(world.camera)
    renderer = ShelfRenderer(caster, scene.shelf)
    size = world.boxes[scene.target].size_m
    poses, view = HiddenPoses(size, scene.shelf, caster), world.look()
    left = poses.feasible(view, [])
    others = [box for name, box in world.boxes.items() if name in view.labels]
    shares = []
    for cell in np.random.default_rng(0).choice(poses.count, 60, replace=False):
        box = Box(*map(float, poses.places_m[cell]), size)
        share = renderer.visible_shares([*others, box])[-1]
        if left[cell]:
            # Only what the core leaves out, at the cell's edges, may show.
            assert share < 0.6
        else:
            assert share > 0.0
        shares.append((left[cell], share))
    assert np.mean([share for kept, share in shares if kept]) < 0.25


def test_an_empty_shelf_hides_nothing():
    shelf = Shelf()
    world = ShelfWorld(Scene(shelf, (), (), ""), np.random.default_rng(0))
    poses = HiddenPoses((0.06, 0.05, 0.1), shelf, BoxCaster(world.camera))
    view = world.look()
    assert not poses.feasible(view, []).any()
    belief = PoseBelief(poses)
    belief.update(view, [])
    # Such a view contradicts that there is a target, and is not believed.
    assert belief.left.all()


def test_unknown_depth_rules_out_nothing():
    shelf = Shelf()
    world = ShelfWorld(
        Scene(shelf, (), (), ""), np.random.default_rng(0), noise=DepthNoise(lost_share=1.0)
    )
    poses = HiddenPoses((0.06, 0.05, 0.1), shelf, BoxCaster(world.camera))
    assert poses.feasible(world.look(), []).all()


def test_a_taller_target_has_fewer_places_to_hide():
    scene = drawn_scenes("pharmacy", SceneRules(15), [1])[0]
    world = ShelfWorld(scene, np.random.default_rng(0))
    caster, view = BoxCaster(world.camera), world.look()
    left = [
        HiddenPoses((0.04, 0.04, height), scene.shelf, caster).feasible(view, []).sum()
        for height in (0.05, 0.08, 0.12, 0.2)
    ]
    assert left == sorted(left, reverse=True)
    assert left[0] > left[-1]


def test_heat_is_the_weight_of_the_poses_times_their_pixels():
    poses = HiddenPoses((0.06, 0.05, 0.1), Shelf(), BoxCaster(front_camera(Shelf())))
    rng = np.random.default_rng(0)
    one, two = rng.random((2, poses.count))
    np.testing.assert_allclose(poses.heat(one + 2 * two), poses.heat(one) + 2 * poses.heat(two))
    single = np.zeros(poses.count)
    single[7] = 1.0
    heat = poses.heat(single)
    assert set(np.unique(heat)) == {0.0, 1.0}
    rows, columns = np.nonzero(heat)
    middle = front_camera(Shelf()).project(np.array([[*poses.places_m[7], 0.05]]))[0]
    np.testing.assert_allclose([columns.mean(), rows.mean()], middle, atol=2.5)


def test_the_minimum_over_time_only_falls():
    minimum, rng = RunningMinimum(), np.random.default_rng(0)
    images = rng.random((5, 4, 6))
    for count, image in enumerate(images, start=1):
        np.testing.assert_array_equal(minimum.update(image), images[:count].min(axis=0))


def test_the_heuristic_is_the_or_of_the_masks():
    scene = drawn_scenes("pharmacy", SceneRules(12), [0])[0]
    world = ShelfWorld(scene, np.random.default_rng(0))
    view = world.look()
    seen = sightings(view, scene.shelf, {}, BoxCaster(world.camera))
    occupancy = mask_occupancy(seen, view.depth_m.shape)
    np.testing.assert_array_equal(occupancy > 0.0, view.segments >= 0)
    flat = along_shelf(occupancy)
    np.testing.assert_allclose(flat.sum(), occupancy.sum())
    assert (flat == flat[:1]).all()
