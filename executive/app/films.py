"""A video of the table cell in a recorded run, from beyond the table."""

from collections.abc import Iterable
from itertools import chain
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from executive.app.scenes import scene_frames
from executive.core.descriptors import standard_error_dropped
from executive.core.errors import InputError, RecordingError
from executive.engine.recording.reader import Recording
from perception.camera import CameraModel
from robots.descriptions.yumi import yumi
from robots.interfaces import Floats
from robots.placement import TABLE_SIZE_M
from robots.viewer import SceneFrame
from simulation.poses import pose_matrices
from simulation.render.primitives import join
from simulation.render.renderer import Renderer
from simulation.render.sensor import SensorParameters, expose
from simulation.render.shapes import cable_shapes, robot_shapes

ColourImage = NDArray[np.uint8]

# Blue, green, red, as OpenCV has them.
WHITE, TRACE = (255, 255, 255), (220, 160, 60)
FONT = cv2.FONT_HERSHEY_SIMPLEX
# So many frames a second, and the cell's time so many times as fast.
FRAMES_HZ, SPEED = 10.0, 4.0
CODECS = {".webm": "VP80", ".mp4": "mp4v"}
SIZE_PX, FOCAL_PX = (720, 480), 760.0
# The lamp of the cell lights what its own camera sees; from elsewhere all is darker.
BRIGHTENED = 2.0
# From beyond the table, over the cable, towards the robot.
EYE_M, TARGET_M = (0.35, 1.25, 1.05), (0.0, -0.08, 0.05)


def write_video(recording: Path, file: Path) -> None:
    """Write a video of the table cell in a run, four times as fast, with what was believed.

    Args:
        recording: Of a cell with a table, two arms and a cable.
        file: `.webm` for browsers, or `.mp4`.

    Raises:
        InputError: The file has another ending, or cannot be written.
        RecordingError: The recording cannot be read, or holds no such cell.
    """
    if file.suffix not in CODECS:
        known = ", ".join(CODECS)
        raise InputError(f"--video {file}: got ending {file.suffix!r}; expected one of: {known}")
    frames = (frame for frame in scene_frames(Recording.open(recording)) if frame.cables_m)
    first = next(frames, None)
    if first is None:
        raise RecordingError(f"{recording}: nothing to film; got no cable; expected a table cell")
    film = _opened(file)
    try:
        _film(chain([first], frames), film)
    finally:
        film.release()


def _opened(file: Path) -> cv2.VideoWriter:
    code = cv2.VideoWriter.fourcc(*CODECS[file.suffix])
    with standard_error_dropped():  # it warns of codes that it then replaces
        film = cv2.VideoWriter(str(file), code, FRAMES_HZ, SIZE_PX)
    if not film.isOpened():
        raise InputError(f"--video {file}: cannot be written; expected a folder that is there")
    return film


def _film(frames: Iterable[SceneFrame], film: cv2.VideoWriter) -> None:
    rng, camera = np.random.default_rng(0), oblique_camera()
    renderer = Renderer(camera, TABLE_SIZE_M, rng)
    due_s = 0.0
    for frame in frames:
        if frame.time_s >= due_s:
            film.write(_drawn(frame, camera, renderer, rng))
            due_s = frame.time_s + SPEED / FRAMES_HZ


def oblique_camera() -> CameraModel:
    """Return a camera that looks over the table at the robot."""
    forward = np.subtract(TARGET_M, EYE_M)
    forward = forward / np.linalg.norm(forward)
    right = np.cross(forward, (0.0, 0.0, 1.0))
    right = right / np.linalg.norm(right)
    T_world_camera = np.eye(4)
    T_world_camera[:3, :3] = np.column_stack([right, np.cross(forward, right), forward])
    T_world_camera[:3, 3] = EYE_M
    middle = (0.5 * (SIZE_PX[0] - 1), 0.5 * (SIZE_PX[1] - 1))
    return CameraModel(*SIZE_PX, FOCAL_PX, middle, T_world_camera)


def _drawn(
    frame: SceneFrame, camera: CameraModel, renderer: Renderer, rng: np.random.Generator
) -> ColourImage:
    poses = np.array(list(frame.link_poses.values()))
    links = dict(zip(frame.link_poses, pose_matrices(poses[:, :3], poses[:, 3:]), strict=True))
    cables = [
        cable_shapes(line_m, frame.cable_radius_m, plug_poses(line_m)) for line_m in frame.cables_m
    ]
    rendering = renderer.render(join([robot_shapes(yumi(), links), *cables]))
    grey = expose(rendering, SensorParameters(speckle=0.0), rng)
    bright = cv2.convertScaleAbs(grey, alpha=BRIGHTENED)
    canvas: ColourImage = np.asarray(cv2.cvtColor(bright, cv2.COLOR_GRAY2BGR), dtype=np.uint8)
    lines = [np.rint(camera.project(line_m)).astype(np.int32) for line_m in frame.cables_m]
    cv2.polylines(canvas, lines, isClosed=False, color=WHITE, thickness=2, lineType=cv2.LINE_AA)
    if frame.trace_m is not None:
        points = np.rint(camera.project(frame.trace_m)).astype(np.int32)
        cv2.polylines(canvas, [points], isClosed=False, color=TRACE, thickness=1)
    caption = f"{frame.time_s:6.1f} s  {frame.caption.replace(' · ', '  ')}"
    cv2.putText(canvas, caption, (12, 24), FONT, 0.6, WHITE, 1, cv2.LINE_AA)
    return canvas


def plug_poses(nodes_m: Floats) -> Floats:
    """Return T_world_plug of both ends of a cable, x out of the end, shape (2, 4, 4)."""
    poses = np.tile(np.eye(4), (2, 1, 1))
    for pose, end, inner in zip(poses, nodes_m[[0, -1]], nodes_m[[2, -3]], strict=True):
        out = (end - inner) / max(float(np.linalg.norm(end - inner)), 1e-9)
        side = np.cross((0.0, 0.0, 1.0), out)
        side = side / max(float(np.linalg.norm(side)), 1e-9)
        pose[:3, :3] = np.column_stack([out, side, np.cross(out, side)])
        pose[:3, 3] = end
    return poses
