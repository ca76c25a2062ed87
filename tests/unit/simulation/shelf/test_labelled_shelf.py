"""Rendered packages: labels where their fronts are, the same picture for the same seed."""

import numpy as np
import pytest

from perception.shelf.casting import BoxCaster
from perception.shelf.rendering import ShelfRenderer
from perception.shelf.types import NOTHING, Box, Shelf
from simulation.shelf.labelled import LabelledShelf, Looks, near_cameras, overview_camera
from simulation.shelf.packages import Package, draw_package
from simulation.shelf.picturing import SensorNoise
from simulation.shelf.taxonomy import shipped_domain

CLEAR = Looks(glare=0.0, dimming=0.0, blur_px=0.0, noise=SensorNoise(0.0, 0.0, 0.0))
SHELF = Shelf()


def chequered():
    """Return a label whose left half is red, and whose lower right quarter is blue."""
    front = np.full((200, 100, 3), 255, np.uint8)
    front[:, :50] = (255, 0, 0)
    front[100:, 50:] = (0, 0, 255)
    return Package((0, 255, 0), front, 0.01)


def photograph(looks, boxes, packages, seed=0, camera=None):
    shelf = LabelledShelf(SHELF, boxes, packages, looks, np.random.default_rng(seed))
    return shelf, shelf.photograph(camera or overview_camera(SHELF, 400))


def test_each_part_of_a_label_is_where_the_camera_model_says():
    box = Box(0.3, 0.1, (0.1, 0.06, 0.2))
    _, picture = photograph(CLEAR, [box], [chequered()])
    y_m = box.low_m[1]
    spots = {(0.27, 0.15): (255, 0, 0), (0.33, 0.15): (255, 255, 255), (0.33, 0.05): (0, 0, 255)}
    for (x_m, z_m), colour in spots.items():
        x, y = picture.frame.camera.project(np.array([[x_m, y_m, z_m]]))[0].round().astype(int)
        np.testing.assert_allclose(picture.frame.colour[y, x], colour, atol=2)


def test_depth_and_segments_are_those_of_the_plain_renderer():
    boxes = [Box(0.3, 0.1, (0.1, 0.06, 0.2)), Box(0.33, 0.25, (0.1, 0.06, 0.1))]
    _, picture = photograph(CLEAR, boxes, [chequered(), chequered()])
    depth_m, segments = ShelfRenderer(BoxCaster(picture.frame.camera), SHELF).render(boxes)
    np.testing.assert_array_equal(picture.segments, segments)
    np.testing.assert_allclose(picture.frame.depth_m, depth_m.astype(np.float32))


def test_what_stands_before_hides_a_label():
    behind, before = Box(0.3, 0.25, (0.1, 0.06, 0.1)), Box(0.3, 0.1, (0.2, 0.06, 0.2))
    plain = Package((0, 255, 0), np.full((8, 8, 3), 90, np.uint8), 0.01)
    _, picture = photograph(CLEAR, [behind, before], [chequered(), plain])
    reds = (picture.frame.colour == (255, 0, 0)).all(axis=2)
    assert not reds.any()


def test_glare_whitens_and_is_told_of():
    box, dark = Box(0.3, 0.1, (0.1, 0.06, 0.2)), Package(
        (10, 10, 10), np.full((200, 100, 3), 10, np.uint8), 0.01
    )  # fmt: skip
    shelf, picture = photograph(
        Looks(1.0, 0.9, 0.0, 0.0, SensorNoise(0.0, 0.0, 0.0)), [box], [dark]
    )
    assert shelf.glaring == (True,)
    assert picture.frame.colour[picture.segments == 0].max() > 200


def test_the_same_seed_gives_the_same_picture():
    thing = shipped_domain("pharmacy").objects[0]
    frames = []
    for seed in (1, 1, 2):
        rng = np.random.default_rng(seed)
        box = Box(0.3, 0.1, (0.07, 0.06, 0.12))
        package = draw_package(thing, box.size_m, rng)
        shelf = LabelledShelf(SHELF, [box], [package], Looks(), rng)
        frames.append(shelf.photograph(overview_camera(SHELF, 320)).frame)
    np.testing.assert_array_equal(frames[0].colour, frames[1].colour)
    np.testing.assert_array_equal(frames[0].depth_m, frames[1].depth_m)
    assert (frames[0].colour != frames[2].colour).any()


def test_three_near_cameras_see_the_whole_width_and_more_of_each_label():
    things = shipped_domain("pharmacy").objects
    rng = np.random.default_rng(0)
    boxes = [Box(x_m, 0.15, (0.08, 0.06, 0.1)) for x_m in np.linspace(0.05, 0.75, 8)]
    packages = [draw_package(thing, boxes[0].size_m, rng) for thing in things[:8]]
    shelf = LabelledShelf(SHELF, boxes, packages, CLEAR, rng)
    overview = overview_camera(SHELF, 400)
    assert set(np.unique(shelf.photograph(overview).segments)) == {NOTHING, *range(8)}
    near = near_cameras(SHELF, 400)
    assert len(near) == 3
    for number in range(8):
        far_px = shelf.letters_px(number, overview)
        assert max(shelf.letters_px(number, camera) for camera in near.values()) > 1.2 * far_px


@pytest.mark.parametrize("size_m", [(0.04, 0.04, 0.05), (0.2, 0.1, 0.04), (0.1, 0.05, 0.25)])
def test_names_fit_on_packages_of_any_shape(size_m):
    for seed in range(6):
        thing = shipped_domain("pharmacy").objects[5]
        package = draw_package(thing, size_m, np.random.default_rng(seed))
        height, width = package.front.shape[:2]
        assert (width, height) == (round(4000 * size_m[0]), round(4000 * size_m[2]))
        assert 0.0005 < package.name_height_m < 0.5 * size_m[2]
