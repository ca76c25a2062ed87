"""Whole searches in the kinematic shelf, by the thesis's rule of success."""

import numpy as np
import pytest
from shelf_search import drawn_scenes, guessed_affinity

from benchmarks.search_trials import Way, search_by
from simulation.shelf.scenes import SceneRules
from simulation.shelf.taxonomy import shipped_domain

GUESS = guessed_affinity(shipped_domain("pharmacy"), np.random.default_rng(1))


@pytest.fixture(scope="module")
def scenes():
    return drawn_scenes("pharmacy", SceneRules(15), range(100, 112))


def test_searches_repeat(scenes):
    way = Way(affinity=GUESS, product="pose", calibrated=True)
    assert search_by(scenes[0], way) == search_by(scenes[0], way)


@pytest.mark.parametrize("spatial", ["belief", "minimum", "masks"])
def test_most_targets_are_found_in_few_actions(scenes, spatial):
    found = [search_by(scene, Way(spatial)) for scene in scenes]
    assert np.mean([one.success for one in found]) >= 0.7
    assert all(1 <= one.actions <= 30 for one in found)


def test_semantics_save_actions_where_the_shelf_is_in_order(scenes):
    plain = [search_by(scene) for scene in scenes]
    guided = [search_by(scene, Way(affinity=GUESS)) for scene in scenes]
    both = [(a.actions, b.actions) for a, b in zip(plain, guided, strict=True)
            if a.success and b.success]  # fmt: skip
    assert len(both) >= 8
    assert np.mean([b - a for a, b in both]) < 0.0
