"""The kinematic cell with labels on its boxes, and what wide images are made into."""

import numpy as np
import pytest

from executive.app.shelf_services import product_reader
from executive.core.errors import InputError
from perception.shelf.casting import BoxCaster
from perception.shelf.coarsening import coarser, coarser_camera
from perception.shelf.detections import ShelfDetector
from perception.shelf.types import Shelf
from simulation.shelf.cameras import front_camera
from simulation.shelf.cell import KinematicShelfCell

CONFIG = {"detector": "looks", "camera": {"width_px": 480}}
SCENARIO = {"domain": "pharmacy", "count": 8}


@pytest.fixture(scope="module")
def cell():
    return KinematicShelfCell(CONFIG, SCENARIO, seed=3)


def test_labels_do_not_change_the_scene(cell):
    plain = KinematicShelfCell({}, SCENARIO, seed=3)
    assert dict(cell.boxes) == dict(plain.boxes)
    again = KinematicShelfCell(CONFIG, SCENARIO, seed=3)
    assert np.array_equal(again.picture().colour, KinematicShelfCell(
        CONFIG, SCENARIO, seed=3).picture().colour)  # fmt: skip


def test_the_detector_of_products_finds_most_of_what_is_told(cell):
    detector = product_reader("pharmacy", text=False)
    assert isinstance(detector, ShelfDetector)
    frame = cell.picture()
    found, told = detector.detect(frame), cell.told(frame)
    assert found.names == told.names
    assert abs(found.count - told.count) <= 2


def test_labels_need_pixels():
    with pytest.raises(InputError, match=r"camera\.width_px: got 160.*try camera\.width_px=480"):
        KinematicShelfCell({"detector": "product"}, SCENARIO, seed=3)


@pytest.mark.parametrize("width_px", [160, 320, 480, 600])
def test_pixels_of_coarser_images_look_where_they_looked_before(width_px):
    fine = front_camera(Shelf(), width_px)
    coarse, step = coarser_camera(fine), max(1, width_px // 160)
    picked = BoxCaster(fine).rays[step // 2 :: step, step // 2 :: step]
    assert np.allclose(BoxCaster(coarse).rays, picked)


def test_coarser_looks_keep_the_numbers_of_objects(cell):
    frame = cell.picture()
    told = cell.told(frame)
    look, seen = coarser(frame, told)
    assert look.depth_m.shape == seen.segments.shape == (120, 160)
    assert set(np.unique(seen.segments)) <= set(np.unique(told.segments))
    assert seen.count == told.count
