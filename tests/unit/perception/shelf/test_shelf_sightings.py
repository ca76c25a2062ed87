"""Boxes from views: what is surely there is there, and what stands free is found."""

import numpy as np
import pytest
from shelf_search import drawn_scenes

from perception.shelf.casting import BoxCaster
from perception.shelf.sightings import sightings
from perception.shelf.types import Box, Shelf
from simulation.shelf.scenes import Scene, SceneRules
from simulation.shelf.world import DepthNoise, ShelfWorld

# Half a pixel at the back of the shelf, and what a front and a side have in common.
TOLERANCE_M = 0.007


def seen_in(scene, sizes=None, noise=None):
    world = ShelfWorld(scene, np.random.default_rng(0), noise=noise)
    known = {name: box.size_m for name, box in world.boxes.items()} if sizes is None else sizes
    return world, sightings(world.look(), scene.shelf, known, BoxCaster(world.camera))


@pytest.mark.parametrize("name", ["pharmacy", "office"])
def test_what_is_surely_there_is_there(name):
    for scene in drawn_scenes(name, SceneRules(18), range(6)):
        world, seen = seen_in(scene)
        for sighting in seen:
            true, sure = world.boxes[sighting.label], sighting.sure
            assert (np.array(sure.low_m) >= np.array(true.low_m) - TOLERANCE_M).all()
            assert (np.array(sure.high_m) <= np.array(true.high_m) + TOLERANCE_M).all()


def test_most_boxes_are_found_where_they_are():
    errors = []
    for scene in drawn_scenes("pharmacy", SceneRules(15), range(8)):
        world, seen = seen_in(scene)
        for sighting in seen:
            true = world.boxes[sighting.label]
            gap = max(abs(sighting.box.x_m - true.x_m), abs(sighting.box.y_m - true.y_m))
            errors.append(gap)
    assert np.mean(np.array(errors) < 0.01) > 0.85


def free_scene(*boxes):
    names = tuple(f"thing {index}" for index in range(len(boxes)))
    return Scene(Shelf(), names, boxes, "")


@pytest.mark.parametrize("noise", [None, DepthNoise(0.002, 0.05)])
def test_a_free_object_is_found_whatever_is_known_of_it(noise):
    scene = free_scene(Box(0.2, 0.1, (0.08, 0.06, 0.12)), Box(0.6, 0.25, (0.06, 0.05, 0.1)))
    for sizes in (None, {}):
        world, seen = seen_in(scene, sizes, noise)
        assert len(seen) == 2
        for sighting in seen:
            true = world.boxes[sighting.label]
            np.testing.assert_allclose(sighting.box.x_m, true.x_m, atol=0.006)
            np.testing.assert_allclose(sighting.box.low_m[1], true.low_m[1], atol=0.008)
            np.testing.assert_allclose(sighting.box.size_m[0], true.size_m[0], atol=0.012)
            np.testing.assert_allclose(sighting.box.size_m[2], true.size_m[2], atol=0.012)


def test_a_half_hidden_object_is_completed_from_its_open_side():
    hidden = Box(0.45, 0.25, (0.2, 0.06, 0.15))
    scene = free_scene(hidden, Box(0.35, 0.05, (0.15, 0.06, 0.25)))
    _, seen = seen_in(scene)
    half = next(sighting for sighting in seen if sighting.label == "thing 0")
    assert half.sure.size_m[0] < 0.17
    assert half.box.x_m == pytest.approx(hidden.x_m, abs=0.008)
