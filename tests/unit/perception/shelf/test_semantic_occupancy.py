"""Where a target stands by the company that objects keep."""

import numpy as np
import pytest
from shelf_search import drawn_scenes, guessed_affinity

from executive.core.errors import InputError
from perception.shelf.affinity import AffinityMatrix, Origin, even_rows
from perception.shelf.organisation import organisation_of
from perception.shelf.original import OriginalScene
from perception.shelf.semantic import (
    column_semantics,
    floor_semantics,
    image_semantics,
    smooth_columns,
)
from perception.shelf.types import Box, Shelf, Sighting
from simulation.shelf.cameras import front_camera
from simulation.shelf.scenes import SceneRules
from simulation.shelf.taxonomy import shipped_domain

NAMES = ("tea", "salt", "rice", "soap")
SIZE = (0.05, 0.05, 0.1)
BOXES = {"salt": Box(0.2, 0.1, SIZE), "rice": Box(0.6, 0.1, SIZE)}


def tea_likes(salt, rice):
    rows = even_rows(4)
    rows[0] = [0.0, salt, rice, 1.0 - salt - rice]
    return AffinityMatrix(NAMES, rows, Origin("by hand"))


def test_a_place_has_the_affinity_of_what_is_nearest_to_it():
    places = np.array([[0.0, 0.3], [0.39, 0.0], [0.41, 0.0], [0.8, 0.3]])
    values = floor_semantics(places, BOXES, tea_likes(0.5, 0.3), "tea")
    np.testing.assert_allclose(values, [0.5, 0.5, 0.3, 0.3])


def test_the_target_itself_and_unknown_objects_say_nothing():
    matrix, places = tea_likes(0.5, 0.3), np.array([[0.5, 0.1]])
    more = {**BOXES, "tea": Box(0.5, 0.1, SIZE), "umbrella": Box(0.5, 0.1, SIZE)}
    np.testing.assert_allclose(
        floor_semantics(places, more, matrix, "tea"), floor_semantics(places, BOXES, matrix, "tea")
    )
    values = floor_semantics(np.zeros((3, 2)), {}, matrix, "tea")
    assert len(set(values)) == 1
    with pytest.raises(InputError, match="unknown object 'coffee'"):
        floor_semantics(places, BOXES, matrix, "coffee")


def test_columns_follow_the_affinities():
    shelf = Shelf()
    camera = front_camera(shelf)
    columns = column_semantics(camera, shelf, BOXES, tea_likes(0.6, 0.1), "tea")
    left_px, right_px = camera.project(np.array([[0.15, 0.1, 0.0], [0.65, 0.1, 0.0]]))[:, 0]
    ratio = columns[int(left_px)] / columns[int(right_px)]
    assert 4.0 < ratio < 6.5
    mirrored = column_semantics(camera, shelf, BOXES, tea_likes(0.1, 0.6), "tea")
    np.testing.assert_allclose(mirrored, columns[::-1], atol=1e-9)


def test_smoothing_keeps_the_sum_and_an_even_distribution():
    np.testing.assert_allclose(smooth_columns(np.full(160, 2.0)), 2.0)
    bump = np.zeros(320)
    bump[150:170] = 1.0
    smoothed = smooth_columns(bump)
    assert smoothed.sum() == pytest.approx(20.0, rel=1e-3)
    x = np.arange(320)
    spread = np.sqrt((smoothed * (x - 159.5) ** 2).sum() / smoothed.sum())
    # The thesis's 50 px of 640 are 25 of 320; the bump's own width adds its 5.8 px.
    assert spread == pytest.approx(np.hypot(25.0, 20.0 / np.sqrt(12.0)), rel=0.03)


def test_in_the_image_the_nearest_mask_decides():
    seen = []
    for label, column in (("salt", 20), ("rice", 140)):
        mask = np.zeros((40, 160), dtype=bool)
        mask[10:30, column - 5 : column + 5] = True
        seen.append(Sighting(label, mask, BOXES[label], BOXES[label]))
    values = image_semantics(seen, tea_likes(0.6, 0.1), "tea")
    assert values.shape == (40, 160)
    np.testing.assert_allclose(values[:, :20], 0.6, atol=0.01)
    np.testing.assert_allclose(values[:, 140:], 0.1, atol=0.01)


def test_the_original_scene_keeps_first_places_and_takes_in_new_objects():
    original, mask = OriginalScene(), np.ones((2, 2), dtype=bool)

    def seen(**boxes):
        return [Sighting(label, mask, box, box) for label, box in boxes.items()]

    original.update(seen(salt=BOXES["salt"]))
    original.update(seen(salt=BOXES["salt"].at(0.7, 0.2), rice=BOXES["rice"]))
    assert original.boxes == BOXES


def test_order_is_told_from_disorder():
    domain = shipped_domain("pharmacy")
    affinity = guessed_affinity(domain, np.random.default_rng(0))

    def mean(organisation):
        scenes = drawn_scenes("pharmacy", SceneRules(15, organisation), range(10))
        all_seen = [dict(zip(scene.names, scene.boxes, strict=True)) for scene in scenes]
        return np.mean([organisation_of(boxes, affinity) for boxes in all_seen])

    assert mean(0.0) < 0.4
    assert mean(1.0) > 0.6
    assert organisation_of({"vitamins": Box(0.1, 0.1, SIZE)}, affinity) == 0.5
