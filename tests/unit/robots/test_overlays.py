"""Overlays are drawn where they are, changed when they change, and taken away when they go."""

import base64
import json
import re

import numpy as np
import pytest
import umsgpack
from meshcat.commands import Delete

from robots.descriptions.yumi import yumi
from robots.placement import table_scene
from robots.viewer import LiveViewer, SceneFrame, Stage, write_html
from robots.viewer.overlays import (
    Dots,
    Screen,
    axes_lines,
    draw_overlay,
    facing,
    joined,
    path_lines,
)

WAY_M = np.array([[0.0, 0.0, 0.1], [0.1, 0.0, 0.1], [0.1, 0.2, 0.1]])
CABLE_M = np.column_stack([np.linspace(0.0, 0.3, 31), np.zeros((31, 2))])


def lowered(overlay):
    command = draw_overlay("it", overlay).lower()
    assert command["path"] == "/overlays/it"
    return command["object"]


def vertices(data, name):
    packed = data["geometries"][0]["data"]["attributes"][name]["array"]
    return np.frombuffer(packed.data, dtype=np.float32).reshape(-1, 3)


def test_a_way_is_drawn_through_its_points_with_the_frame_at_its_end():
    lines = joined(path_lines(WAY_M, (1.0, 0.5, 0.0)), axes_lines(WAY_M[-1], np.eye(3), 0.05))
    data = lowered(lines)
    assert data["object"]["type"] == "LineSegments"
    ends_m = vertices(data, "position")
    assert ends_m[:4] == pytest.approx(WAY_M[[0, 1, 1, 2]])
    assert ends_m[5::2] - ends_m[4::2] == pytest.approx(0.05 * np.eye(3))
    assert vertices(data, "color")[4::2] == pytest.approx(np.eye(3))


def test_dots_keep_their_places_and_colours():
    data = lowered(Dots(WAY_M, np.eye(3), 0.01))
    assert data["object"]["type"] == "Points"
    assert vertices(data, "position") == pytest.approx(WAY_M)
    assert vertices(data, "color") == pytest.approx(np.eye(3))


def test_a_screen_stands_upright_and_faces_the_eye():
    eye_m = np.array([0.8, 1.5, 1.0])
    T = facing(np.array([-0.9, -0.5, 0.3]), eye_m)
    assert T[:3, :3] @ T[:3, :3].T == pytest.approx(np.eye(3))
    assert T[:3, 1] == pytest.approx([0.0, 0.0, 1.0])
    assert T[:3, 2] @ (eye_m - T[:3, 3]) > 0.9 * np.linalg.norm(eye_m - T[:3, 3])
    data = lowered(Screen(b"png", T, 0.6, 0.4))
    matrix = np.array(data["object"]["matrix"]).reshape(4, 4).T  # three.js has columns first
    assert matrix == pytest.approx(T)
    assert base64.b64encode(b"png").decode() in data["images"][0]["url"]


def test_what_is_no_more_is_taken_away():
    assert isinstance(draw_overlay("it", None), Delete)


def test_a_replay_holds_each_change_of_an_overlay_once(tmp_path):
    plan, other = path_lines(WAY_M, (1, 1, 1)), path_lines(-WAY_M, (1, 1, 1))
    shown = [{}, {"plan": plan}, {"plan": plan}, {"plan": other}, {}]
    frames = [SceneFrame(0.5 * k, {}, CABLE_M, 0.003, overlays=o) for k, o in enumerate(shown)]
    write_html(Stage(yumi(), table_scene()), frames, tmp_path / "page.html")
    changes = recorded(tmp_path / "page.html")["overlays"]["plan"]
    assert [time for time, _ in changes] == [0.5, 1.5, 2.0]
    kinds = [umsgpack.unpackb(base64.b64decode(text))["type"] for _, text in changes]
    assert kinds == ["set_object", "set_object", "delete"]


def test_a_replay_holds_all_cables(tmp_path):
    short_m = CABLE_M[:11] + np.array([0.0, 0.1, 0.0])
    frame = SceneFrame(0.0, {}, CABLE_M, 0.003, more_cables_m=(short_m,))
    write_html(Stage(yumi(), table_scene()), [frame], tmp_path / "page.html")
    recording = recorded(tmp_path / "page.html")
    assert recording["cables"] == [31, 11]
    row = np.frombuffer(base64.b64decode(recording["frames"]), dtype="<i2")
    points_m = row[7 * len(recording["links"]) :].reshape(-1, 3) * recording["metre"]
    assert points_m == pytest.approx(np.vstack([CABLE_M, short_m]), abs=1e-4)


def test_a_live_view_draws_overlays_and_cables_and_takes_overlays_away():
    viewer = LiveViewer(Stage(yumi(), table_scene()), min_interval_s=0.0)
    lines = path_lines(WAY_M, (1, 1, 1))
    try:
        for overlays in ({"plan": lines, "target": Dots(WAY_M, np.eye(3), 0.01)}, {"plan": lines}):
            viewer.show(
                SceneFrame(0.0, {}, CABLE_M, 0.003, None, None, "", {}, (CABLE_M,), overlays)
            )
        viewer._socket.send(b"get_scene")
        page = viewer._socket.recv().decode()
    finally:
        viewer.close()
    texts = re.findall(r"octet-binary;base64,([^\"]+)", page)
    paths = {umsgpack.unpackb(base64.b64decode(text))["path"] for text in texts}
    assert {"/cable", "/cable_1", "/overlays/plan"} <= paths
    assert "/overlays/target" not in paths


def recorded(page):
    text = page.read_text(encoding="utf-8")
    return json.loads(re.search(r'id="recording"[^>]*>(.*?)</script>', text)[1])
