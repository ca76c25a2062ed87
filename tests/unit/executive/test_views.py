"""Live view and replay follow the same messages and show the same."""

import json
from collections import Counter

import numpy as np
import pytest
from toy_runs import RUNNING, Leaf, built, header_of

from executive.app import views
from executive.app.overlays import target_overlay
from executive.app.scenes import SceneFollower, scene_frames
from executive.core.errors import DeviceError, InputError, RecordingError
from executive.core.world import StreamMessage
from executive.engine.blackboard import Write
from executive.engine.recording.reader import Recording
from executive.engine.recording.writer import RecordingWriter
from executive.engine.ticks import NodeStatus, Tick
from perception.cable.types import Trace, TraceEnd
from perception.camera import CameraFrame, CameraModel
from robots.viewer import rerun_file
from simulation.streams import scene_json

DOWN = np.diag([1.0, -1.0, -1.0, 1.0])
DOWN[2, 3] = 1.0
CAMERA = CameraModel(200, 100, 100.0, (99.5, 49.5), DOWN)
PIXELS = np.array([[99.5, 49.5], [149.5, 49.5], [149.5, 99.5]])
TRACE = Trace(PIXELS, TraceEnd.ENDPOINT, 0.9)
NODES_M = np.column_stack([np.linspace(0.0, 0.3, 31), np.zeros(31), np.full(31, 0.004)])


def camera_frame() -> CameraFrame:
    image = np.zeros((100, 200), np.uint8)
    return CameraFrame(image, image.astype(np.float32), 0.0, CAMERA)


def scene(time_s: float) -> StreamMessage:
    """Return a scene in which the cable rises and one link moves."""
    lift_m = np.array([0.0, 0.0, time_s])
    quat_xyzw = np.array([[0.0, 0.0, 0.0, 1.0]])
    data = scene_json(["left_link_1"], lift_m[None], quat_xyzw, [NODES_M + lift_m], 0.0035)
    return StreamMessage("/scene", "Scene", time_s, data)


TICKS = [
    Tick(0, 0.0, 0.001, changes=((0, NodeStatus.RUNNING),)),
    Tick(1, 0.1, 0.001, writes=(Write("m:frame", camera_frame(), "look"),
                                Write("m:trace", TRACE, "trace"))),
    Tick(2, 0.2, 0.001, writes=(Write("m:knotted_probability", 0.25, "knots"),)),
    Tick(3, 0.3, 0.001),
]  # fmt: skip


def play(*observers) -> None:
    """Tell observers of the toy run: each tick is followed by what the cell streamed."""
    joints = b'{"names": ["left_joint_1"], "positions": [0.5], "velocities": [0.0]}'
    other = StreamMessage("/joint_states", "JointStates", 0.05, joints)
    for tick in TICKS:
        for observer in observers:
            observer.on_tick(tick)
            observer.on_streams([other, scene(tick.time_s + 0.05), scene(tick.time_s + 0.1)])


class Screen:
    """Stands for the viewer: keeps the frames, or breaks."""

    url = "http://127.0.0.1/"

    def __init__(self, stage, broken=False):
        self.frames, self.broken, self.shows, self.closed = [], broken, 0, False

    def show(self, frame):
        self.shows += 1
        if self.broken:
            raise DeviceError("viewer: gone")
        self.frames.append(frame)

    def close(self):
        self.closed = True


@pytest.fixture
def recording(tmp_path):
    path = tmp_path / "run.mcap"
    with RecordingWriter(path, header_of(built(Leaf("look_at_it", RUNNING)), seed=3)) as writer:
        play(writer)
    return path


def test_replay_shows_the_scene_as_it_was_known_at_each_tick(recording):
    frames = list(scene_frames(Recording.open(recording)))
    assert [frame.time_s for frame in frames] == pytest.approx([0.1, 0.2, 0.3])
    for frame in frames:
        assert frame.link_poses["left_link_1"][2] == pytest.approx(frame.time_s)
        assert frame.cable_m[:, 2] == pytest.approx(0.004 + frame.time_s)
    last = frames[-1]
    assert last.cable_radius_m == 0.0035
    assert last.caption == "look_at_it · P(knotted) 0.25"


def test_all_cables_are_shown():
    quat_xyzw = np.array([[0.0, 0.0, 0.0, 1.0]])
    lines_m = [NODES_M, NODES_M[:9]]
    data = scene_json(["left_link_1"], np.zeros((1, 3)), quat_xyzw, lines_m, 0.0035)
    follower = SceneFollower()
    follower.on_stream(StreamMessage("/scene", "Scene", 0.0, data))
    assert [len(line_m) for line_m in follower.frame(0.0).cables_m] == [31, 9]


def test_a_plan_is_shown_until_it_has_ended():
    follower = SceneFollower()
    follower.on_stream(scene(0.0))
    ways = {"left": [[0.1 * k, 0.0, 0.2, 0.0, 0.0, 0.0, 1.0] for k in range(3)]}
    for tools in (ways, {}):
        data = json.dumps({"tools": tools, "duration_s": 1.0}).encode()
        follower.on_stream(StreamMessage("/plan", "Plan", 0.0, data))
        assert ("plan" in follower.frame(0.0).overlays) == bool(tools)


def test_live_and_replay_show_the_picture_that_was_looked_at(recording, monkeypatch):
    replayed = list(scene_frames(Recording.open(recording)))
    shown = []
    monkeypatch.setattr(views, "LiveViewer", lambda stage: shown.append(Screen(stage)) or shown[0])
    play(views.open_live_view("table_cell"))
    pictures = [each[-1].overlays["picture"] for each in (replayed, shown[0].frames)]
    assert pictures[0].png == pictures[1].png
    assert pictures[0].height_m == pytest.approx(0.5 * pictures[0].width_m)


def test_where_a_target_may_be_is_brighter_where_it_is_likelier():
    places_m = np.array([[0.1, 0.1], [0.2, 0.1], [0.3, 0.1]])
    dots = target_overlay(places_m, np.array([0.6, 0.4, 1e-9]))
    assert dots.points_m[:, :2] == pytest.approx(places_m[:2])
    assert dots.colours[0].sum() > dots.colours[1].sum()
    assert target_overlay(places_m[:0], np.zeros(0)) is None


def test_trace_and_camera_are_laid_on_the_table(recording):
    frame = list(scene_frames(Recording.open(recording)))[-1]
    assert frame.trace_m == pytest.approx(np.array([[0, 0, 0], [0.5, 0, 0], [0.5, -0.5, 0]]))
    assert CAMERA.project(frame.trace_m) == pytest.approx(PIXELS)
    assert frame.camera.position_m == pytest.approx([0.0, 0.0, 1.0])
    assert frame.camera.corners_m[0] == pytest.approx([-1.0, 0.5, 0.0])
    assert frame.camera.corners_m[2] == pytest.approx([1.0, -0.5, 0.0])


def test_replay_is_a_page_named_after_the_run(recording, tmp_path):
    page = tmp_path / "run.html"
    views.write_html(recording, page)
    assert "<title>toy, seed 3</title>" in page.read_text(encoding="utf-8")


def test_a_rerun_file_has_scene_images_joints_and_what_was_done(recording, tmp_path):
    rerun = pytest.importorskip("rerun")
    views.write_rerun(recording, tmp_path / "run.rrd")
    chunks = rerun.chunk.RrdReader(str(tmp_path / "run.rrd")).stream().to_chunks()
    rows = Counter[str]()
    for chunk in chunks:  # an entity has more than one where writing was slow
        if not chunk.is_static:
            rows[chunk.entity_path] += chunk.num_rows
    assert rows["/world/robot/left_link_1"] == rows["/world/cable"] == 3
    assert rows["/world/trace"] == rows["/world/camera"] == rows["/image"] == 1
    assert rows["/doing"] == 2
    assert rows["/joints/left_joint_1"] == len(TICKS)


def test_without_rerun_the_message_says_what_to_install(recording, tmp_path, monkeypatch):
    monkeypatch.setattr(rerun_file, "find_spec", lambda _: None)
    with pytest.raises(InputError, match=r"--rerun: needs rerun-sdk, .* try pip install 'cellwri"):
        views.write_rerun(recording, tmp_path / "run.rrd")
    assert not (tmp_path / "run.rrd").exists()


def test_a_recording_without_a_scene_has_no_replay(tmp_path):
    path = tmp_path / "run.mcap"
    with RecordingWriter(path, header_of(built(Leaf("idle", RUNNING)))) as writer:
        writer.on_tick(TICKS[0])
    with pytest.raises(RecordingError, match="without scene messages"):
        views.write_html(path, tmp_path / "run.html")


def test_live_view_shows_what_the_replay_shows(recording, monkeypatch):
    monkeypatch.setattr(views, "LiveViewer", Screen)
    live = views.open_live_view("table_cell")
    play(live)
    live.close()
    shown, replayed = live._viewer.frames, list(scene_frames(Recording.open(recording)))
    assert live._viewer.closed
    assert shown[-1].trace_m == pytest.approx(replayed[-1].trace_m)
    assert shown[-1].camera.corners_m == pytest.approx(replayed[-1].camera.corners_m)
    same = [frame for frame in shown if frame.time_s == pytest.approx(0.2)]
    assert same[0].cable_m == pytest.approx(replayed[1].cable_m)


def test_a_viewer_that_breaks_goes_dark_and_the_run_goes_on(monkeypatch, caplog):
    monkeypatch.setattr(views, "LiveViewer", lambda stage: Screen(stage, broken=True))
    live = views.open_live_view("table_cell")
    play(live)
    assert live._viewer.shows == 1
    assert "viewer: gone" in caplog.text
