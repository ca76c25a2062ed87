"""Products found in rendered pictures: segments, names by looks and text, nearer views."""

import numpy as np
import pytest

from executive.core.errors import InputError
from perception.shelf.detection.appearance import AppearanceModel
from perception.shelf.detection.detector import ProductDetector
from perception.shelf.detection.matching import matched, overlaps
from perception.shelf.detection.products import product_detector
from perception.shelf.detection.reading import RapidReader, TextLine
from perception.shelf.detection.segmenting import segmented, shelf_points
from perception.shelf.detection.wording import Wording
from perception.shelf.detections import ShelfDetector
from simulation.shelf.labelled import Looks, near_cameras, overview_camera
from simulation.shelf.scenes import SceneRules
from simulation.shelf.taxonomy import shipped_domain
from simulation.shelf.teaching import labelled_scene

DOMAIN = shipped_domain("pharmacy")
WORDINGS = [Wording(thing.name, thing.brand) for thing in DOMAIN.objects]


class Told:
    """Reads what it was given, line for line, wherever it is in the part that it is shown."""

    def __init__(self):
        self.lines, self.asked = [], 0

    def read(self, image):
        self.asked += 1
        return tuple(self.lines)


def line(text, x, y, height_px=8.0):
    wide = 0.5 * height_px
    corners = [
        (x - wide, y - wide),
        (x + wide, y - wide),
        (x + wide, y + wide),
        (x - wide, y + wide),
    ]
    return TextLine(text, 0.9, np.array(corners, float))


def even_looks():
    return AppearanceModel(DOMAIN.names, np.zeros(23), np.ones(23), np.zeros((24, 27)))


@pytest.fixture(scope="module")
def pictures():
    made = []
    for seed in range(4):
        scene, shelf = labelled_scene(DOMAIN, SceneRules(12), Looks(), seed)
        camera = overview_camera(scene.shelf, 480)
        made.append((scene, shelf, shelf.photograph(camera), shelf.visible_shares(camera)))
    return made


def test_objects_are_told_apart_by_depth_alone(pictures):
    good = all_of = 0
    for scene, _, picture, shares in pictures:
        found = segmented(shelf_points(picture.frame, scene.shelf))
        shared = overlaps(picture.segments, found)
        for number in np.flatnonzero(shares > 0.2).tolist():
            all_of += 1
            good += bool(shared[number].max() > 0.7)
    assert good >= 0.85 * all_of


def test_colours_do_not_matter_to_what_stands_apart(pictures):
    scene, _, picture, _ = pictures[0]
    first = segmented(shelf_points(picture.frame, scene.shelf))
    assert first.min() == -1
    assert set(np.unique(first)) == {*range(-1, first.max() + 1)}


def test_an_empty_shelf_has_no_objects(pictures):
    scene, _, picture, _ = pictures[0]
    frame = picture.frame
    empty = frame.depth_m.copy()
    empty[...] = np.nan
    detector = ProductDetector(scene.shelf, WORDINGS, even_looks(), Told())
    bare = type(frame)(frame.colour, empty, 0.0, frame.camera)
    assert detector.detect(bare).count == 0


@pytest.fixture
def view(pictures):
    """A scene with a reader that finds the name of one object, and which object that is."""
    scene, shelf, picture, shares = pictures[1]
    told = Told()
    detector = ProductDetector(scene.shelf, WORDINGS, even_looks(), told)
    objects = detector.find(picture.frame)
    pairs = matched(picture.segments, objects.segments)
    number = max(pairs, key=lambda one: shares[one])
    rows, columns = np.nonzero(picture.segments == number)
    points = objects.points.things.nonzero()
    room = round(0.01 * picture.frame.colour.shape[1])
    corner = max(0, points[1].min() - room), max(0, points[0].min() - room)
    at = (np.median(columns) - corner[0], np.median(rows) - corner[1])
    return scene, shelf, picture, detector, told, pairs[number], scene.names[number], at


def test_what_is_written_on_an_object_names_it_and_no_other(view):
    _, _, picture, detector, told, number, name, at = view
    told.lines = [line(name.upper(), *at)]
    detections = detector.detect(picture.frame)
    assert isinstance(detector, ShelfDetector)
    assert detections.names[detections.probabilities[number].argmax()] == name
    assert detections.probabilities[number].max() > 0.8
    others = np.delete(detections.probabilities, number, axis=0)
    np.testing.assert_allclose(others, others[0, 0])


def test_what_names_nothing_is_unknown(view):
    _, _, picture, detector, told, number, _, at = view
    told.lines = [line("Zwiebelkuchen", *at)]
    assert detector.detect(picture.frame).probabilities[number].sum() < 0.3


def test_text_beside_objects_is_on_none(view):
    _, _, picture, detector, told, _, name, _ = view
    told.lines = [line(name, -5.0, -5.0)]
    rows = detector.detect(picture.frame).probabilities
    np.testing.assert_allclose(rows, rows[0, 0])


def test_the_surest_reading_of_all_views_is_kept(view):
    _, _, picture, detector, told, number, name, at = view
    objects = detector.find(picture.frame)
    told.lines = [line(name[:3], *at)]
    once = detector.readings(objects, [picture.frame])
    told.lines = [line(name, *at)]
    twice = detector.readings(objects, [picture.frame], once)
    told.lines = [line("new", *at)]
    thrice = detector.readings(objects, [picture.frame], twice)
    column = DOMAIN.names.index(name)
    assert once[number, column] < twice[number, column]
    np.testing.assert_array_equal(thrice, twice)


def test_text_in_a_nearer_view_is_laid_on_the_same_object(view):
    scene, shelf, picture, detector, told, number, name, _ = view
    objects = detector.find(picture.frame)
    which = scene.names.index(name)
    found = 0
    for viewpoint, camera in near_cameras(scene.shelf, 480).items():
        near = shelf.photograph(camera, viewpoint)
        if (near.segments == which).sum() < 200:
            continue
        rows, columns = np.nonzero(near.segments == which)
        things = shelf_points(near.frame, scene.shelf).things.nonzero()
        room = round(0.01 * near.frame.colour.shape[1])
        corner = max(0, things[1].min() - room), max(0, things[0].min() - room)
        told.lines = [line(name, np.median(columns) - corner[0], np.median(rows) - corner[1])]
        row = detector.readings(objects, [near.frame])[:, DOMAIN.names.index(name)]
        found += int(row.argmax() == number and row[number] > 0.5)
    assert found >= 1


def test_without_a_reader_looks_alone_count(view):
    scene, _, picture, *_ = view
    detector = ProductDetector(scene.shelf, WORDINGS, even_looks(), None)
    rows = detector.detect(picture.frame).probabilities
    np.testing.assert_allclose(rows, rows[0, 0])


def test_the_detector_that_ships_knows_its_domain():
    detector = product_detector("pharmacy", WORDINGS, None)
    scene, shelf = labelled_scene(DOMAIN, SceneRules(12), Looks(), 11)
    rows = detector.detect(shelf.photograph(overview_camera(scene.shelf, 480)).frame).probabilities
    assert rows.shape[1] == 27
    assert rows.max() > 0.3
    with pytest.raises(InputError, match="no model of 'pharmcy'; did you mean 'pharmacy'"):
        product_detector("pharmcy", WORDINGS, None)
    with pytest.raises(InputError, match="no wording of advil"):
        product_detector("pharmacy", [w for w in WORDINGS if w.name != "advil"], None)


def test_a_reader_that_is_not_installed_says_how_to_have_it(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "rapidocr_onnxruntime", None)
    with pytest.raises(InputError, match="pip install --no-deps rapidocr-onnxruntime"):
        RapidReader()
