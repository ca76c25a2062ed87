"""Examples for the detector of looks: what is yielded, and that scenes repeat."""

import numpy as np

from simulation.shelf.labelled import Looks, overview_camera
from simulation.shelf.scenes import SceneRules
from simulation.shelf.taxonomy import shipped_domain
from simulation.shelf.teaching import examples, labelled_scene, taught

DOMAIN = shipped_domain("kitchen")


def test_a_seed_gives_one_scene_and_one_look_of_it():
    pictures = []
    for _ in range(2):
        scene, shelf = labelled_scene(DOMAIN, SceneRules(10), Looks(), 3)
        pictures.append((scene.digest, shelf.photograph(overview_camera(scene.shelf, 240)).frame))
    assert pictures[0][0] == pictures[1][0]
    np.testing.assert_array_equal(pictures[0][1].colour, pictures[1][1].colour)


def test_examples_are_products_of_the_domain_with_features_that_are_numbers():
    pairs = [*examples(DOMAIN, 0), *examples(DOMAIN, 1)]
    assert len(pairs) > 8
    assert {name for name, _ in pairs} <= set(DOMAIN.names)
    assert len({features.shape for _, features in pairs}) == 1
    assert np.isfinite([features for _, features in pairs]).all()


def test_a_model_learns_what_it_is_shown():
    model = taught(DOMAIN, scenes=3)
    pairs = [pair for seed in range(7_000_000, 7_000_003) for pair in examples(DOMAIN, seed)]
    rows = model.probabilities(np.array([features for _, features in pairs]))
    right = [DOMAIN.names[row.argmax()] == name for row, (name, _) in zip(rows, pairs, strict=True)]
    assert np.mean(right) > 0.8
