import numpy as np
import pytest

from executive.core.errors import InputError
from perception.training import blender
from perception.training.blender import need_blender, shown_by_blender
from perception.training.scenes import SceneConfig, make_scene

CONFIG = SceneConfig(extent=24.0, narrowest_px=6.0, widest_px=6.0, cables=1, family="random")


def test_without_blender_it_says_what_to_install(monkeypatch):
    monkeypatch.setattr(blender, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"pip install --no-deps bpy"):
        need_blender()


def test_blender_that_fails_is_said(monkeypatch):
    monkeypatch.setattr(blender, "SCRIPT", "perception.training.no_such_script")
    rng = np.random.default_rng(1)
    with pytest.raises(InputError, match=r"no image; Blender says: .*no_such_script"):
        shown_by_blender(rng, make_scene(rng, CONFIG))


def test_blender_shows_the_cable_where_the_truth_says():
    pytest.importorskip("bpy", exc_type=ImportError)
    rng = np.random.default_rng(2)
    scene = shown_by_blender(rng, make_scene(rng, CONFIG))
    cable, image = scene.cables[0], scene.image.astype(float)
    inside = np.all((cable.points_px > 1) & (cable.points_px < len(image) - 2), axis=1)
    columns, rows = np.round(cable.points_px[inside]).astype(int).T
    on_cable, table = np.median(image[rows, columns]), np.median(image)
    assert abs(on_cable - table) > 10.0
