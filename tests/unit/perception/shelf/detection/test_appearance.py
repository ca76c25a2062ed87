"""A softmax of looks: what it learns, and files that come and go."""

import numpy as np
import pytest

from executive.core.errors import InputError
from perception.shelf.detection.appearance import features_of, load_appearance, trained
from perception.shelf.detection.segmenting import ShelfPoints

NAMES = ("low", "high", "wide")


@pytest.fixture(scope="module")
def model():
    rng = np.random.default_rng(0)
    labels = rng.integers(3, size=300)
    centres = np.array([[0.0, 0.0, 1.0], [4.0, 0.0, 1.0], [0.0, 4.0, 1.0]])
    return trained(NAMES, centres[labels] + rng.normal(size=(300, 3)), labels)


def test_what_is_apart_is_told_apart_and_what_is_between_is_doubtful(model):
    rows = model.probabilities(np.array([[0.0, 0.0, 1.0], [4.0, 0.0, 1.0], [2.0, 0.0, 1.0]]))
    np.testing.assert_allclose(rows.sum(axis=1), 1.0)
    assert rows[0].argmax() == 0
    assert rows[1].argmax() == 1
    assert 0.2 < rows[2, 0] < 0.8


def test_a_model_comes_back_from_its_file(model, tmp_path):
    model.save(tmp_path / "m.json", "toy", "by a test")
    again = load_appearance(tmp_path / "m.json")
    points = np.random.default_rng(1).normal(size=(5, 3))
    assert again.names == NAMES
    np.testing.assert_allclose(again.probabilities(points), model.probabilities(points), atol=1e-3)


def test_files_that_are_no_models_are_told_of(model, tmp_path):
    path = tmp_path / "m.json"
    with pytest.raises(InputError, match="cannot be read"):
        load_appearance(path)
    path.write_text("{}")
    with pytest.raises(InputError, match="not an appearance model"):
        load_appearance(path)
    model.save(path, "toy", "by a test")
    path.write_text(path.read_text().replace('"low", ', ""))
    with pytest.raises(InputError, match="expected features x names"):
        load_appearance(path)


def box_features(colour, scale_m=1.0, brightness=1.0):
    image = np.full((20, 20, 3), 30, np.uint8)
    image[5:15, 5:15] = np.round(np.array(colour) * brightness)
    x, z = np.meshgrid(np.arange(20) * 0.01, np.arange(20)[::-1] * 0.01)
    points_m = scale_m * np.stack([x, np.full_like(x, 0.1), z], axis=-1)
    mask = np.zeros((20, 20), bool)
    mask[5:15, 5:15] = True
    return features_of(image, ShelfPoints(points_m, mask), mask)


def test_sizes_are_measured_in_metres_and_colours_by_hue():
    red, blue = box_features((200, 20, 20)), box_features((20, 20, 200))
    np.testing.assert_allclose(red[:3], blue[:3])
    # Ten pixels of a centimetre, in tenths of a metre.
    assert red[0] == pytest.approx(0.9, abs=0.05)
    assert box_features((200, 20, 20), scale_m=2.0)[0] == pytest.approx(2 * red[0], rel=1e-6)
    assert not np.allclose(red[7:19], blue[7:19])
    dim = box_features((200, 20, 20), brightness=0.5)
    np.testing.assert_allclose(dim[7:19], red[7:19], atol=1e-6)
