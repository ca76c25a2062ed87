"""The kinematic shelf: what it shows, what moves, and why something does not."""

import numpy as np
import pytest
from shelf_rows import CUBE, scene_of

from perception.shelf.casting import BoxCaster
from perception.shelf.planning.moves import Place, Push
from perception.shelf.planning.room import Reach, footprints, overlapping
from perception.shelf.types import NOTHING
from simulation.shelf.contents import MoveFailure
from simulation.shelf.scenes import SceneRules, draw_scene
from simulation.shelf.taxonomy import shipped_domain
from simulation.shelf.world import DepthNoise, ShelfWorld


def world_of(scene, **options):
    return ShelfWorld(scene, np.random.default_rng(0), **options)


def random_scene(seed, rules=SceneRules(15)):  # noqa: B008 - frozen
    return draw_scene(shipped_domain("pharmacy"), rules, np.random.default_rng(seed))


def test_what_is_seen_lies_on_the_surface_of_what_it_is_said_to_be():
    world = world_of(random_scene(0))
    view, caster = world.look(), BoxCaster(world.camera)
    points = caster.origin_m + view.depth_m[..., None].astype(float) * caster.rays
    for index, label in enumerate(view.labels):
        box, mine = world.boxes[label], points[view.segments == index]
        away = np.maximum(np.array(box.low_m) - mine, mine - np.array(box.high_m)).max(axis=1)
        np.testing.assert_allclose(away, 0.0, atol=1e-6)
    walls = points[(view.segments == NOTHING) & np.isfinite(view.depth_m)]
    gaps = np.stack([walls[:, 0], 0.8 - walls[:, 0], 0.35 - walls[:, 1], walls[:, 2],
                     0.57 - walls[:, 2]])  # fmt: skip
    np.testing.assert_allclose(gaps.min(axis=0), 0.0, atol=1e-6)


def test_nothing_stands_between_the_camera_and_what_it_sees():
    """Points along rays, short of the depth that is seen, are in no box: a second, slow way."""
    world = world_of(random_scene(1))
    view, caster = world.look(), BoxCaster(world.camera)
    known = np.isfinite(view.depth_m)
    rays, depth = caster.rays[known], view.depth_m[known].astype(float)
    for share in np.linspace(0.7, 0.999, 40):
        points = caster.origin_m + (share * depth)[:, None] * rays
        for box in world.boxes.values():
            within = (points > np.array(box.low_m) + 1e-6) & (points < np.array(box.high_m) - 1e-6)
            assert not within.all(axis=1).any()


def test_hidden_objects_do_not_show_in_a_view():
    scene = random_scene(2)
    view = world_of(scene).look()
    assert scene.target not in view.labels
    assert set(np.unique(view.segments)) == {NOTHING, *range(len(view.labels))}


def test_a_push_goes_as_far_as_asked_or_until_contact():
    world = world_of(scene_of(a=(0.2, 0.1), b=(0.5, 0.12)))
    result = world.act(Push("a", 0.05))
    assert result.failure is None
    assert result.moved_m == pytest.approx(0.05)
    assert result.short_m == pytest.approx(0.0)
    result = world.act(Push("a", 1.0))
    assert world.boxes["b"].x_m == 0.5
    assert 0.0 < world.boxes["b"].low_m[0] - world.boxes["a"].high_m[0] < 0.003
    assert result.moved_m + result.short_m == pytest.approx(1.0)
    assert world.act(Push("b", 5.0)).failure is MoveFailure.NO_BLADE


def test_a_push_ends_at_the_wall():
    world = world_of(scene_of(a=(0.2, 0.1)))
    world.act(Push("a", 5.0))
    assert world.boxes["a"].high_m[0] == pytest.approx(0.8)


def test_a_push_stops_at_what_is_not_seen():
    world = world_of(scene_of(front=(0.41, 0.05), hidden=(0.4, 0.16), side=(0.2, 0.16)))
    assert "hidden" not in world.look().labels
    assert world.act(Push("side", 0.5)).short_m > 0.3
    assert world.boxes["side"].high_m[0] < world.boxes["hidden"].low_m[0]


@pytest.mark.parametrize(
    ("move", "failure"),
    [
        (Push("hidden", 0.1), MoveFailure.NOT_SEEN),
        (Push("nobody", 0.1), MoveFailure.NOT_SEEN),
        (Push("wall", -0.1), MoveFailure.NO_ROOM),
        (Push("wall", 0.1), MoveFailure.NO_BLADE),
        (Push("pair", 0.1), MoveFailure.NO_BLADE),
        (Push("pair", -0.1), MoveFailure.NO_ROOM),
        (Place("behind", 0.5, 0.1), MoveFailure.OBSTRUCTED),
        (Place("front", 0.6, 0.3), MoveFailure.NO_PLACE),
        (Place("front", 0.6, 0.25), MoveFailure.NO_PLACE),
        (Place("front", 0.79, 0.25), MoveFailure.NO_PLACE),
        (Place("front", 0.5, 0.4), MoveFailure.NO_PLACE),
    ],
)
def test_what_cannot_be_done_changes_nothing_and_says_why(move, failure):
    scene = scene_of(
        front=(0.4, 0.05), hidden=(0.4, 0.13), wall=(0.03, 0.2), mate=(0.185, 0.29),
        pair=(0.245, 0.3), behind=(0.62, 0.28), before=(0.6, 0.1),
    )  # fmt: skip
    world = world_of(scene)
    before = dict(world.boxes)
    result = world.act(move)
    assert result.failure is failure
    assert result.moved_m == 0.0
    assert world.boxes == before


def test_without_a_cup_nothing_is_taken_out():
    world = world_of(scene_of(a=(0.4, 0.1)), reach=Reach(suction=False))
    assert world.act(Place("a", 0.6, 0.2)).failure is MoveFailure.NO_SUCTION


def test_a_placed_object_stands_where_it_was_put():
    world = world_of(scene_of(a=(0.4, 0.1), b=(0.2, 0.1)))
    assert world.act(Place("a", 0.6, 0.2)).failure is None
    assert (world.boxes["a"].x_m, world.boxes["a"].y_m) == (0.6, 0.2)
    assert world.boxes["a"].size_m == CUBE


def test_whatever_is_done_one_object_moves_and_none_overlap():
    world, rng = world_of(random_scene(5)), np.random.default_rng(1)
    for _ in range(60):
        label = str(rng.choice(world.look().labels))
        if rng.random() < 0.5:
            move = Push(label, float(rng.uniform(-0.5, 0.5)))
        else:
            move = Place(label, float(rng.uniform(0.0, 0.8)), float(rng.uniform(0.0, 0.35)))
        before = dict(world.boxes)
        result = world.act(move)
        moved = [name for name, box in world.boxes.items() if box != before[name]]
        assert moved == ([] if result.failure else [label])
        rows = footprints(list(world.boxes.values()))
        hits = overlapping(rows[:, None], rows[None])
        assert hits.sum() == len(rows)


def test_a_lone_object_is_wholly_visible_and_a_covered_one_is_not():
    world = world_of(scene_of(front=(0.4, 0.05), hidden=(0.4, 0.13), free=(0.6, 0.2)))
    assert world.visible_share("free") == 1.0
    assert world.visible_share("hidden") == 0.0
    world.act(Push("front", 0.03))
    assert 0.0 < world.visible_share("hidden") < 1.0
    world.act(Push("front", 0.1))
    assert world.visible_share("hidden") == 1.0


def test_noise_is_what_was_asked_for_and_repeats_with_its_seed():
    scene = random_scene(6)
    clean = world_of(scene).look().depth_m
    noise = DepthNoise(spread_m=0.003, lost_share=0.1)
    one, two = (world_of(scene, noise=noise).look().depth_m for _ in range(2))
    np.testing.assert_array_equal(one, two)
    known = np.isfinite(clean)
    assert np.isnan(one[known]).mean() == pytest.approx(0.1, abs=0.02)
    assert np.nanstd((one - clean)[known]) == pytest.approx(0.003, rel=0.1)
