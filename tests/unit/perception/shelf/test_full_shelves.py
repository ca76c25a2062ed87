"""Shelves where no short plan shows the target: what is hidden is looked for, or none is found."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from shelf_search import drawn_scenes

from benchmarks.search_ours import OurSearcher, search_ours
from perception.shelf.hidden_poses import HiddenPoses
from perception.shelf.planning.choosing import best_plan, forgetful
from perception.shelf.planning.contacts import contact_beside
from perception.shelf.planning.exploring import RULES, THING_M, unseen_things
from perception.shelf.planning.looking_ahead import ANYHOW, Situation
from perception.shelf.planning.moves import Push
from perception.shelf.planning.proofs import pushes_may_show
from perception.shelf.planning.room import Reach
from perception.shelf.types import Box, Shelf
from simulation.shelf.cameras import front_camera
from simulation.shelf.contents import ShelfContents
from simulation.shelf.scenes import Scene, SceneRules
from simulation.shelf.world import ShelfWorld

SHELF = Shelf()
PUSHES = Reach(blade_m=0.0, suction=False, by_sight=True)
TARGET = Box(0.15, 0.31, (0.06, 0.06, 0.1))
# A wide box at the left wall hides the target, and a small one behind another box stops it.
WIDE = Box(0.151, 0.15, (0.3, 0.2, 0.25))
COVER = Box(0.42, 0.02, (0.2, 0.038, 0.25))
HIDDEN = Box(0.41, 0.2, (0.08, 0.08, 0.15))


def situation(boxes, met=()):
    return Situation(
        shelf=SHELF, reach=PUSHES, camera=front_camera(SHELF),
        labels=tuple(f"box {number}" for number in range(len(boxes))), boxes=tuple(boxes),
        movable=np.full(len(boxes), ANYHOW), met=np.array(met).reshape(-1, 4),
        floor=np.ones((80, 35), dtype=bool), cell_m=0.01, target_m=TARGET.size_m,
        places_m=np.array([[TARGET.x_m, TARGET.y_m]]), weights=np.ones(1),
    )  # fmt: skip


def test_what_is_hidden_and_stops_a_push_is_found_and_moved():
    scene = Scene(SHELF, ("wide", "cover", "hidden", "target"), (WIDE, COVER, HIDDEN, TARGET),
                  "target")  # fmt: skip
    trial = search_ours(scene, None, PUSHES)
    assert trial.success
    assert trial.actions <= 6


def test_small_things_are_looked_for_where_none_has_been_ruled_out():
    boxes = {"cover": COVER, "hidden": HIDDEN, "target": TARGET}
    scene = Scene(SHELF, tuple(boxes), tuple(boxes.values()), "target")
    searcher = OurSearcher(scene, None, PUSHES)
    things = HiddenPoses(THING_M, SHELF, searcher.reasoner._caster(front_camera(SHELF)), RULES)
    searcher.look()
    unseen_m = things.places_m[searcher.belief.unseen]
    # Before the cover all is seen; behind it something may stand.
    assert (unseen_m[:, 1] > COVER.y_m).all()
    assert np.abs(unseen_m - (HIDDEN.x_m, HIDDEN.y_m)).max(axis=1).min() < 0.02
    before = searcher.belief.unseen
    searcher.act(Push("cover", 0.25))
    searcher.look()
    assert (searcher.belief.unseen <= before).all()
    assert searcher.belief.unseen.sum() < 0.5 * before.sum()


def test_they_are_likelier_where_something_was_met():
    places_m = np.array([[0.1, 0.1], [0.405, 0.15], [0.7, 0.3]])
    made = situation([], met=[(0.4, 0.1, 0.41, 0.2)])
    assert unseen_things(made) is None
    unseen = unseen_things(replace(made, unseen_m=places_m))
    assert unseen.weights[1] > 5.0 * unseen.weights[[0, 2]].max()
    assert unseen.weights.sum() == pytest.approx(1.0)


def test_what_still_blocks_an_object_is_not_forgotten():
    box = Box(0.4, 0.15, (0.1, 0.1, 0.2))
    touching, elsewhere = contact_beside(box, 1), contact_beside(box.at(0.1, 0.15), 1)
    kept = forgetful(situation([box], met=[touching, elsewhere])).met
    assert np.allclose(kept, touching[None])


@pytest.mark.parametrize("seed", [700, 701, 702])
def test_no_move_that_has_failed_is_tried_again_at_once(seed):
    rules = SceneRules(18, scale=1.0)
    (scene,) = drawn_scenes("pharmacy", rules, [seed])
    searcher = OurSearcher(scene, None, PUSHES)
    tried = []
    for _ in range(12):
        searcher.look()
        move = searcher.choose()
        if move is None or searcher.shows():
            break
        tried.append((move, searcher.act(move).failure))
    for (before, failure), (after, _) in pairwise(tried):
        if failure is not None:
            same = before.label == after.label and before.shift_m * after.shift_m > 0.0
            assert not same


@pytest.mark.parametrize("seed", range(6))
def test_no_pushes_at_random_show_what_is_proved_never_to_show(seed):
    """Small shelves, so that chance comes near everything that can be reached."""
    rng = np.random.default_rng(seed)
    scene = _small(rng)
    target = scene.names.index("target")
    camera = front_camera(scene.shelf)
    may, world = {}, ShelfWorld(scene, rng, reach=PUSHES)
    for share in (0.0, 0.3):
        may[share] = pushes_may_show(
            scene.boxes, target, scene.shelf, camera, PUSHES.gap_m, share=share, by_sight=True
        )
    assert may[0.0] or not may[0.3]
    best = 0.0
    contents = ShelfContents(scene, PUSHES)
    for _ in range(300):
        seen = world.look().labels
        name = seen[int(rng.integers(len(seen)))]
        if name == "target":
            break
        contents.push(name, float(rng.choice([-1.0, 1.0]) * rng.uniform(0.01, 0.5)))
        world = ShelfWorld(
            replace(scene, boxes=tuple(contents.boxes[each] for each in scene.names)), rng
        )
        best = max(best, world.visible_share("target"))
    assert may[0.0] or best == 0.0
    assert may[0.3] or best < 0.3


def test_what_can_never_be_seen_is_never_moved():
    """The hidden box cannot be pushed, since it never shows, so the wide one stays, too."""
    shelf = Shelf(width_m=0.5)
    wide, cover = Box(0.151, 0.15, (0.3, 0.2, 0.25)), Box(0.25, 0.02, (0.4, 0.038, 0.25))
    boxes = (wide, cover, Box(0.36, 0.2, (0.08, 0.08, 0.15)), TARGET.at(0.06, 0.31))
    camera = front_camera(shelf)
    assert pushes_may_show(boxes, 3, shelf, camera, 0.0)
    assert not pushes_may_show(boxes, 3, shelf, camera, 0.0, by_sight=True)


def test_where_nothing_is_unknown_and_nothing_moves_there_is_no_plan():
    full = Box(0.4, 0.1, (0.8, 0.1, 0.3))
    assert best_plan(situation([full])) is None


def _small(rng):
    """Draw a narrow shelf with few boxes, and a hidden target behind them."""
    shelf = Shelf(width_m=0.3, depth_m=0.3)
    while True:
        sizes = rng.uniform((0.05, 0.05, 0.12), (0.16, 0.08, 0.25), (4, 3))
        rows_m = np.array([0.05, 0.05, 0.15, 0.15])
        x_m = rng.uniform(0.5 * sizes[:, 0], 0.3 - 0.5 * sizes[:, 0])
        boxes = [
            Box(float(x), float(y), tuple(map(float, size)))
            for x, y, size in zip(x_m, rows_m, sizes, strict=True)
        ]
        pairs = [(0, 1), (2, 3)]
        apart = all(abs(x_m[a] - x_m[b]) > 0.5 * (sizes[a, 0] + sizes[b, 0]) for a, b in pairs)
        target = Box(0.15, 0.26, (0.06, 0.06, 0.1))
        names = ("a", "b", "c", "d", "target")
        scene = Scene(shelf, names, (*boxes, target), "target")
        if apart and ShelfWorld(scene, rng).visible_share("target") == 0.0:
            return scene
