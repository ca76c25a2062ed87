"""Contact sheets and videos of a recorded run on the simulated cell."""

import json
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

from executive.app.films import oblique_camera, plug_poses, write_video
from executive.core.errors import InputError, RecordingError
from executive.inspector.sheet import write_sheet

CELLWRIGHT = str(Path(sys.executable).with_name("cellwright"))


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    nodes = [[-0.35 + 0.7 * k / 100, 0.05, 0.0033] for k in range(101)]
    (folder / "straight.json").write_text(json.dumps({"nodes_m": nodes}), encoding="utf-8")
    file = folder / "run.mcap"
    command = [CELLWRIGHT, "run", "untangle", "--json", "--record", str(file)]
    command += ["--set", f"cable.file={folder / 'straight.json'}"]
    subprocess.run(command, check=True, capture_output=True)
    return file


@pytest.mark.sim
def test_pictures_show_the_looks_and_the_cell(recording, tmp_path):
    sheet, video = tmp_path / "looks.png", tmp_path / "run.webm"
    write_sheet(recording, sheet)
    image = cv2.imread(str(sheet))
    # Two looks before a claim, each with a trace in colour.
    assert image.shape == (387, 4 * 516, 3) or image.shape == (386, 4 * 516, 3)
    for look in (image[:, :516], image[:, 516:1032]):
        coloured = np.ptp(look.astype(int), axis=2) > 60
        assert coloured.sum() > 200
    assert not image[:, 1032:].any()
    write_video(recording, video)
    film = cv2.VideoCapture(str(video))
    seen, frame = film.read()
    assert seen
    assert frame.shape == (480, 720, 3)
    assert frame.max() > 120


def test_what_cannot_be_written_is_said(recording, tmp_path):
    with pytest.raises(InputError, match=r"got ending '\.gif'; expected one of: \.webm, \.mp4"):
        write_video(recording, tmp_path / "run.gif")
    with pytest.raises(InputError, match="cannot be written"):
        write_sheet(recording, tmp_path / "nowhere" / "looks.png")
    with pytest.raises(RecordingError):
        write_sheet(tmp_path / "none.mcap", tmp_path / "looks.png")


def test_the_camera_of_videos_looks_over_the_table_at_the_robot():
    camera = oblique_camera()
    places = camera.project(np.array([[0.0, 0.0, 0.0], [0.3, 0.0, 0.0], [0.0, 0.0, 0.2]]))
    assert (np.abs(places[0] - np.array([359.5, 239.5])) < 60.0).all()
    assert places[1][0] < places[0][0]  # seen from beyond the table, x runs to the left
    assert places[2][1] < places[0][1]  # up is up


def test_plugs_point_out_of_the_ends():
    nodes = np.column_stack([np.linspace(0.0, 0.2, 21), np.zeros(21), np.full(21, 0.003)])
    poses = plug_poses(nodes)
    assert np.allclose(poses[0, :3, 0], (-1.0, 0.0, 0.0))
    assert np.allclose(poses[1, :3, 0], (1.0, 0.0, 0.0))
    assert np.allclose(poses[:, :3, :3].transpose(0, 2, 1) @ poses[:, :3, :3], np.eye(3))
