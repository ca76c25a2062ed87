import cv2
import numpy as np
import pytest

from perception.training import dataset
from perception.training.connectors import draw_connectors, draw_up_connectors
from perception.training.dataset import DataSettings, draw_image, write_images
from perception.training.drawn import DrawnScene, describe_scene
from perception.training.looks import LEAST_CONTRAST, STYLES, draw_look
from perception.training.scenes import SceneConfig, make_scene

SMALL = SceneConfig(extent=24.0, narrowest_px=5.0, widest_px=7.0)


def at(points, node):
    return np.array([np.interp(node, np.arange(len(points)), axis) for axis in np.array(points).T])


@pytest.mark.parametrize("seed", range(4))
def test_the_truth_on_disk_is_that_of_the_scene(seed):
    scene = make_scene(np.random.default_rng(seed), SMALL)
    truth = DrawnScene.model_validate_json(describe_scene(scene, "a.png").model_dump_json())
    assert truth.size_px == scene.image.shape[::-1]
    for drawn, cable in zip(truth.cables, scene.cables, strict=True):
        assert np.allclose(drawn.points_px, cable.points_px, atol=1e-4)
    for crossing in truth.crossings:
        heights = []
        for place in (crossing.over, crossing.under):
            cable = truth.cables[place.cable]
            gap = np.linalg.norm(at(cable.points_px, place.node) - crossing.position_px)
            assert gap < 0.3 * truth.width_px
            heights.append(np.interp(place.node, np.arange(len(cable.heights)), cable.heights))
        assert heights[0] > heights[1]
    assert len(truth.ends) == 2 * len(truth.cables)
    for end in truth.ends:
        assert np.linalg.norm(end.inwards) == pytest.approx(1.0, abs=1e-3)
        tips = [truth.cables[end.cable].points_px[k] for k in (0, -1)]
        assert end.position_px in tips


def test_images_do_not_depend_on_how_many_there_are(tmp_path):
    few, many = (DataSettings(images=n, width_px=(4.0, 5.0)) for n in (2, 3))
    assert list(write_images(few, tmp_path)) == [0, 1]
    stored = cv2.imread(str(tmp_path / "000001.png"), cv2.IMREAD_GRAYSCALE)
    assert np.array_equal(stored, draw_image(many, 1).image)


def test_a_file_is_whole_or_not_there(tmp_path, monkeypatch):
    monkeypatch.setattr(dataset, "encoded", lambda image: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        list(write_images(DataSettings(images=1, width_px=(4.0, 4.0)), tmp_path))
    assert {path.name for path in tmp_path.iterdir()} == {"data.json"}


@pytest.mark.parametrize("style", sorted(STYLES))
def test_cables_of_every_style_differ_from_their_table(style):
    for seed in range(60):
        look = draw_look(np.random.default_rng(seed), 3, style=style)
        for cable in look.cables:
            levels = np.array([look.table.level, cable.brightness, cable.brightness * cable.stripe])
            table, *seen = 255.0 * (levels.clip(0.0, 255.0) / 255.0) ** look.lens.gamma
            assert np.abs(np.array(seen) - table).min() > LEAST_CONTRAST - 1.0


@pytest.mark.parametrize("style", sorted(STYLES))
def test_centre_lines_lie_on_what_is_drawn(style):
    found = []
    for seed in range(6):
        rng = np.random.default_rng([seed, 5])
        scene = make_scene(rng, SceneConfig(extent=30.0, style=style, cables=1, family="random"))
        image, cable = scene.image.astype(float), scene.cables[0]
        along = np.gradient(cable.points_px, axis=0)
        side = np.column_stack([-along[:, 1], along[:, 0]])
        side *= 1.6 * cable.width_px / np.linalg.norm(side, axis=1, keepdims=True)
        places = [cable.points_px + shift * side for shift in (0.0, 1.0, -1.0)]
        inside = np.all(
            [((p > 1) & (p < np.array(image.shape[::-1]) - 2)).all(axis=1) for p in places], axis=0
        )
        grey = [image[tuple(np.round(p[inside]).astype(int).T[::-1])] for p in places]
        found.append(np.median(np.abs(grey[0] - 0.5 * (grey[1] + grey[2]))))
    assert np.median(found) > 15.0


def test_scenes_without_difference_have_cables_of_one_look():
    for seed in range(20):
        look = draw_look(np.random.default_rng(seed), 3, alike=True)
        assert look.cables[0] == look.cables[1] == look.cables[2]


def test_connectors_hide_what_lies_under_them_and_nothing_else():
    line = np.column_stack([np.arange(100.0, 200.0, 4.0), np.full(25, 150.0)])
    for seed in range(12):
        for connector in draw_up_connectors(np.random.default_rng(seed), 0, line, 8.0, 200.0):
            drawn = np.full((300, 300), -1.0, np.float32)
            draw_connectors(drawn, [connector], 1.0)
            rows, columns = np.nonzero(drawn >= 0.0)
            middle = connector.outlines_px[0].mean(axis=0)
            assert connector.hides(middle) is not connector.covered
            assert not connector.hides(line[12])
            # It begins at the cable's end and leads away from it.
            tip = line[0] if connector.end == 0 else line[-1]
            assert np.linalg.norm(connector.outlines_px[0][:2].mean(axis=0) - tip) < 1e-6
            assert (columns.mean() < 100.0) == (connector.end == 0)
            assert abs(rows.mean() - 150.0) < 2.0
