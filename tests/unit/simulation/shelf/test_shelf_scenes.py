"""Scenes of objects on a shelf: the same for a seed, sound, and as well ordered as asked."""

import numpy as np
import pytest

from executive.core.errors import InputError
from perception.shelf.casting import BoxCaster
from perception.shelf.planning.room import footprints, overlapping
from perception.shelf.rendering import ShelfRenderer
from perception.shelf.types import Shelf
from simulation.shelf.cameras import front_camera
from simulation.shelf.scenes import SceneRules, draw_scene
from simulation.shelf.separating import separate
from simulation.shelf.taxonomy import shipped_domain

CASES = [
    ("pharmacy", SceneRules(12)),
    ("pharmacy", SceneRules(15, scale=1.0)),
    ("pharmacy", SceneRules(21, organisation=0.5)),
    ("kitchen", SceneRules(18)),
    ("kitchen", SceneRules(15, organisation=0.0)),
    ("office", SceneRules(21)),
]


def drawn(name, rules, seed):
    return draw_scene(shipped_domain(name), rules, np.random.default_rng(seed))


@pytest.mark.parametrize(("name", "rules"), CASES)
def test_scenes_are_sound(name, rules):
    for seed in (3, 4):
        scene = drawn(name, rules, seed)
        boxes = footprints(scene.boxes)
        assert len(scene.boxes) == rules.count == len(set(scene.names))
        assert (boxes[:, :2] >= 0.0).all()
        assert (boxes[:, 2:] <= (scene.shelf.width_m, scene.shelf.depth_m)).all()
        hits = overlapping(boxes[:, None], boxes[None])
        assert (hits == np.eye(rules.count, dtype=bool)).all()
        renderer = ShelfRenderer(BoxCaster(front_camera(scene.shelf)), scene.shelf)
        assert renderer.visible_shares(scene.boxes)[scene.names.index(scene.target)] == 0.0


@pytest.mark.parametrize(("name", "rules", "digest"), [
    ("pharmacy", SceneRules(15), "fb73c38ed5b0faf0"),
    ("kitchen", SceneRules(12, organisation=0.5), "2e2164c92df3ea49"),
    ("office", SceneRules(21, organisation=0.0), "155de7cea418c1fb"),
])  # fmt: skip
def test_a_seed_gives_the_same_scene_everywhere(name, rules, digest):
    assert drawn(name, rules, 7).digest[:16] == digest
    assert drawn(name, rules, 8).digest[:16] != digest


def test_objects_keep_better_company_the_more_a_shelf_is_organised():
    domain = shipped_domain("pharmacy")
    categories = {thing.name: thing.category or (thing.name,) for thing in domain.objects}

    def kept(organisation):
        scores = []
        for seed in range(12):
            scene = drawn("pharmacy", SceneRules(15, organisation=organisation), seed)
            centres = np.array([(box.x_m, box.y_m) for box in scene.boxes])
            apart = ((centres[:, None] - centres[None]) ** 2).sum(axis=2)
            np.fill_diagonal(apart, np.inf)
            keys = [categories[name] for name in scene.names]
            scores += [keys[i] == keys[j] for i, j in enumerate(apart.argmin(axis=1))]
        return np.mean(scores)

    none, half, full = kept(0.0), kept(0.5), kept(1.0)
    assert none + 0.1 < half < full - 0.1


def test_separating_leaves_alone_what_stands_apart_and_gives_up_on_what_cannot():
    shelf, rng = Shelf(), np.random.default_rng(2)
    sizes = np.full((6, 2), 0.06)
    apart = np.column_stack([np.linspace(0.1, 0.7, 6), np.full(6, 0.15)])
    np.testing.assert_array_equal(separate(apart, sizes, shelf), apart)
    piled = np.full((6, 2), 0.2) + 0.01 * rng.random((6, 2))
    places = separate(piled, sizes, shelf)
    hits = overlapping(*(np.hstack([places - 0.03, places + 0.03])[axis] for axis in (
        (slice(None), None), (None, slice(None))
    )))  # fmt: skip
    assert hits.sum() == 6
    assert separate(piled, np.full((6, 2), 0.3), shelf) is None


@pytest.mark.parametrize(
    ("rules", "words"),
    [
        (SceneRules(28), "count: got 28; expected 2 to 27"),
        (SceneRules(12, organisation=1.5), "organisation: got 1.5"),
        (SceneRules(12, scale=0.0), "scale: got 0"),
    ],
)
def test_rules_that_cannot_be_are_refused(rules, words):
    with pytest.raises(InputError, match=words):
        drawn("pharmacy", rules, 0)


def test_objects_that_never_fit_are_told_of():
    with pytest.raises(InputError, match=r"no scene of 39 objects .* smaller scale than 1"):
        drawn("office", SceneRules(39, scale=1.0), 0)
