"""The viewer: what a replay holds, that a browser plays it, and how the live server ends."""

import base64
import json
import re
import shutil
import subprocess
import sys

import numpy as np
import pytest
import umsgpack

from executive.core.errors import DeviceError, RecordingError
from robots.descriptions.model import Capsule
from robots.descriptions.yumi import yumi
from robots.placement import YUMI_AT_TABLE, table_scene
from robots.viewer import CameraCone, LiveViewer, SceneFrame, Stage, live, write_html
from robots.viewer.frame import thinned
from robots.viewer.html import METRE
from robots.viewer.shapes import capsule_profile, drawn

CORNERS_M = np.array([[-0.5, -0.4, 0.0], [0.5, -0.4, 0.0], [0.5, 0.4, 0.0], [-0.5, 0.4, 0.0]])
STAGE = Stage(yumi(), table_scene())
CAMERA = CameraCone(np.array([0.0, 0.0, 1.0]), CORNERS_M)
RADIUS_M = 0.0035
HAND = "left_gripper_base"


def frame(time_s: float, trace_m=None, caption: str = "") -> SceneFrame:
    """Return a frame with one moving hand over a cable that wanders along x."""
    turn_rad = 0.3 * time_s
    pose = np.array([0.1, 0.2, 0.3 + 0.01 * time_s, 0, 0, np.sin(turn_rad), np.cos(turn_rad)])
    s = np.linspace(-1.0, 1.0, 301)
    cable_m = np.column_stack([0.4 * s, 0.2 * np.sin(6 * s + time_s), np.full_like(s, 0.004)])
    return SceneFrame(time_s, {HAND: pose}, cable_m, RADIUS_M, trace_m, CAMERA, caption)


def recording_in(path) -> dict:
    """Return the data that a replay plays."""
    found = re.search(r'id="recording"[^>]*>(.*?)</script>', path.read_text(encoding="utf-8"))
    return json.loads(found[1])


def numbers(text: str):
    """Return the integers that a replay stores as text."""
    return np.frombuffer(base64.b64decode(text), dtype="<i2")


@pytest.mark.parametrize(("given", "wanted", "kept"), [(301, 120, 120), (50, 120, 50)])
def test_thinning_keeps_both_ends(given, wanted, kept):
    points = np.arange(3.0 * given).reshape(-1, 3)
    thin = thinned(points, wanted)
    assert len(thin) == kept
    assert (thin[0] == points[0]).all()
    assert (thin[-1] == points[-1]).all()


def test_outline_of_a_capsule_is_one_radius_from_its_segment():
    profile = capsule_profile(0.2, 0.05)
    along = np.clip(profile[:, 1], -0.1, 0.1)
    distance = np.hypot(profile[:, 0], profile[:, 1] - along)
    assert distance == pytest.approx(0.05)
    assert profile[:, 1].max() == pytest.approx(0.15)


@pytest.mark.parametrize("end_m", [(0.1, 0.2, 0.3), (0.0, -0.4, 0.0), (0.1, 0.0, 0.0)])
def test_a_capsule_lies_along_its_segment(end_m):
    start_m = (0.1, 0.0, 0.0)
    _, T_link_shape = drawn(Capsule(start_m, end_m, 0.05))
    half_m = np.linalg.norm(np.subtract(end_m, start_m)) / 2
    tips = [T_link_shape @ [0.0, y, 0.0, 1.0] for y in (-half_m, half_m)]
    assert tips[0][:3] == pytest.approx(start_m, abs=1e-12)
    assert tips[1][:3] == pytest.approx(end_m, abs=1e-12)


def test_stage_draws_every_shape_and_puts_the_robot_in_its_place():
    lowered = [command.lower() for command in STAGE.commands()]
    paths = {command["path"] for command in lowered if command["type"] == "set_object"}
    shapes = {f"/robot/{li.name}/{n}" for li in STAGE.robot.links for n in range(len(li.shapes))}
    assert shapes <= paths
    assert {"/cell/table", "/cell/cloth"} <= paths
    root = next(c for c in lowered if c["type"] == "set_transform" and c["path"] == "/robot/body")
    T_world_body = np.reshape(root["matrix"], (4, 4)).T
    assert T_world_body[:3, 3] == pytest.approx(YUMI_AT_TABLE.position_m)
    assert T_world_body[:3, 0] == pytest.approx([0.0, 1.0, 0.0])  # it looks along +y


def test_replay_holds_what_was_shown(tmp_path):
    path = tmp_path / "run.html"
    frames = [frame(0.1 * k) for k in range(50)]
    write_html(STAGE, iter(frames), path)
    recording = recording_in(path)
    assert recording["links"] == [HAND]
    assert recording["times"] == pytest.approx([each.time_s for each in frames])
    rows = numbers(recording["frames"]).reshape(-1, recording["width"])
    for row, shown in zip(rows, frames, strict=True):
        assert row[:3] * METRE == pytest.approx(shown.link_poses[HAND][:3], abs=METRE)
        assert row[3:7] / 32767 == pytest.approx(shown.link_poses[HAND][3:], abs=1e-4)
        cable_m = row[7:].reshape(-1, 3) * METRE
        assert cable_m == pytest.approx(thinned(shown.cable_m, len(cable_m)), abs=METRE)


def test_replay_keeps_the_rate_and_the_last_frame(tmp_path):
    path = tmp_path / "run.html"
    write_html(STAGE, (frame(5.0 + 0.02 * k) for k in range(104)), path, rate_hz=5.0)
    times_s = recording_in(path)["times"]
    assert times_s[:3] == pytest.approx([0.0, 0.2, 0.4])
    assert times_s[-1] == pytest.approx(103 * 0.02)


def test_replay_of_a_long_run_stays_small(tmp_path):
    path = tmp_path / "run.html"
    write_html(STAGE, (frame(0.1 * k) for k in range(6000)), path)
    times_s = recording_in(path)["times"]
    assert 1200 <= len(times_s) <= 2402
    assert times_s[-1] == pytest.approx(599.9)
    assert path.stat().st_size < 10_000_000


def test_links_that_a_frame_leaves_out_stay(tmp_path):
    path = tmp_path / "run.html"
    still = SceneFrame(1.0, {}, frame(1.0).cable_m, RADIUS_M)
    write_html(STAGE, [frame(0.0), still], path)
    recording = recording_in(path)
    rows = numbers(recording["frames"]).reshape(-1, recording["width"])
    assert (rows[0, :7] == rows[1, :7]).all()


def test_replay_holds_changes_of_trace_and_caption_only(tmp_path):
    path = tmp_path / "run.html"
    trace_m = frame(0.0).cable_m[::10]
    notes = ["look", "look", "dilate </script> & pull", "done"]
    traces = [None, trace_m, trace_m, None]
    shown = [frame(float(k), traces[k], notes[k]) for k in range(4)]
    write_html(STAGE, shown, path, title="Untangle <1>")
    recording = recording_in(path)
    assert recording["captions"] == [[0.0, "look"], [2.0, "dilate </script> & pull"], [3.0, "done"]]
    assert [time_s for time_s, _ in recording["traces"]] == [1.0, 3.0]
    first, second = (numbers(points) for _, points in recording["traces"])
    assert first.reshape(-1, 3) * METRE == pytest.approx(trace_m, abs=METRE)
    assert len(second) == 0
    assert "<title>Untangle &lt;1&gt;</title>" in path.read_text(encoding="utf-8")


def test_replay_loads_nothing_from_elsewhere(tmp_path):
    path = tmp_path / "run.html"
    write_html(STAGE, [frame(0.0), frame(1.0)], path)
    text = path.read_text(encoding="utf-8")
    assert re.findall(r"<(?:script|link|img|iframe)[^>]*(?:src|href)=", text) == []


def test_a_run_without_frames_has_no_replay(tmp_path):
    with pytest.raises(RecordingError, match="nothing to show"):
        write_html(STAGE, [], tmp_path / "run.html")


@pytest.mark.skipif(shutil.which("chromium") is None, reason="needs a browser")
def test_a_browser_plays_the_replay(tmp_path):
    path = tmp_path / "run.html"
    write_html(STAGE, [frame(0.1 * k, caption=f"at {k}") for k in range(100)], path)
    options = [
        "--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader",
        "--enable-unsafe-swiftshader", "--virtual-time-budget=3000", "--dump-dom",
        f"--user-data-dir={tmp_path / 'profile'}",
    ]  # fmt: skip
    page = subprocess.run(
        ["chromium", *options, f"{path.as_uri()}#t=4.25"],
        capture_output=True, text=True, check=True, timeout=120,
    ).stdout  # fmt: skip
    assert '<span id="clock">4.3 s of 9.9 s</span>' in page
    assert '<span id="note">at 42</span>' in page


def test_live_view_gives_latecomers_the_latest_frame():
    viewer = LiveViewer(STAGE, min_interval_s=0.0)
    try:
        assert viewer.url.startswith("http://127.0.0.1:")
        viewer.show(frame(0.0, trace_m=frame(0.0).cable_m))
        viewer.show(frame(1.0))
        viewer._socket.send(b"get_scene")
        page = viewer._socket.recv().decode()
    finally:
        viewer.close()
    commands = [umsgpack.unpackb(base64.b64decode(text)) for text in
                re.findall(r"octet-binary;base64,([^\"]+)", page)]  # fmt: skip
    moved = [c for c in commands if c["path"] == f"/robot/{HAND}" and c["type"] == "set_transform"]
    assert moved[0]["matrix"][14] == pytest.approx(0.31)
    drawn_paths = {c["path"] for c in commands if c["type"] == "set_object"}
    assert {"/cable", "/camera/sight"} <= drawn_paths
    assert "/trace" not in drawn_paths


def test_closing_ends_the_server():
    viewer = LiveViewer(STAGE)
    viewer.close()
    viewer.close()
    assert viewer._server.returncode is not None


def test_frames_in_quick_succession_are_left_out(monkeypatch):
    viewer = LiveViewer(STAGE, min_interval_s=60.0)
    sent = []
    try:
        monkeypatch.setattr(viewer, "_send", sent.append)
        viewer.show(frame(0.0))
        after_one = len(sent)
        viewer.show(frame(1.0))
    finally:
        viewer.close()
    assert after_one > 0
    assert len(sent) == after_one


def test_a_server_that_does_not_start_is_named(monkeypatch):
    monkeypatch.setattr(live, "SERVER_COMMAND", (sys.executable, "-c", "print('no port is free')"))
    with pytest.raises(DeviceError, match=r"no port is free.*try:"):
        LiveViewer(STAGE)


def test_a_server_that_dies_is_noticed(monkeypatch):
    monkeypatch.setattr(live, "_ANSWER_MS", 200)
    viewer = LiveViewer(STAGE, min_interval_s=0.0)
    try:
        viewer._server.kill()
        viewer._server.wait()
        with pytest.raises(DeviceError, match="does not answer"):
            viewer.show(frame(0.0))
    finally:
        viewer.close()
