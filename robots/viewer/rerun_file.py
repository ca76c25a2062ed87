"""The cell in three dimensions as a file for the Rerun viewer; an optional extra.

The same frames as those of the Meshcat page, beside whatever else has a time: images, texts and
numbers. The viewer is `rerun FILE`, which the extra brings too; it reads files of its own minor
version and the one before it, so a recording of ours is what to keep.
"""

from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
from scipy.spatial.transform import Rotation

from executive.core.errors import InputError, RecordingError
from robots.descriptions.model import Box, Capsule, Link, RobotDescription
from robots.interfaces import Floats
from robots.placement import PlanningScene
from robots.viewer.frame import CameraCone, SceneFrame, overlay_changes
from robots.viewer.overlays import Dots, Lines, Overlay, Screen

TIMELINE = "cell"
_CABLE, _TRACE, _BOX, _SIGHT = (244, 244, 240), (255, 154, 46), (185, 166, 138), (91, 141, 239)
_TRACE_RADIUS_M = 0.006
_MOVED = 1e-5  # metres, or parts of a unit quaternion


def need_rerun(command: str) -> None:
    """Make sure that files for Rerun can be written here.

    Raises:
        InputError: They cannot.
    """
    if find_spec("rerun") is None:
        raise InputError(
            f"{command}: needs rerun-sdk, which the extra `rerun` brings; "
            "try pip install 'cellwright[rerun]'"
        )


class RerunFile:
    """A file for Rerun being written; every entity is in the world frame [m], z up."""

    def __init__(self, path: Path, title: str) -> None:
        """Create the file.

        Args:
            path: The file; what is there is replaced.
            title: Shown in the viewer.

        Raises:
            RecordingError: It cannot be written.
        """
        import rerun

        try:
            path.open("wb").close()  # Rerun itself only warns
        except OSError as cause:
            raise RecordingError(f"{path}: cannot write it; got {cause.strerror}") from cause
        self._rerun: Any = rerun
        self._file = rerun.RecordingStream("cellwright", send_properties=False)
        self._file.set_log_time_enabled(False)
        self._file.set_log_tick_enabled(False)
        self._file.save(str(path))
        self._file.send_recording_name(title)
        self._poses: dict[str, Floats] = {}
        self._trace: Floats | None = None
        self._overlays: Mapping[str, Overlay] = {}
        self._camera: CameraCone | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._file.disconnect()

    def set_stage(self, robot: RobotDescription, scene: PlanningScene) -> None:
        """Put up what stands still, and the shapes of the links."""
        self._still("world", self._rerun.ViewCoordinates.RIGHT_HAND_Z_UP)
        for box in scene.boxes:
            half_m = np.array(box.size_m) / 2.0
            self._still(
                f"world/cell/{box.name}",
                self._rerun.Boxes3D(
                    centers=[box.centre_m], half_sizes=[half_m], colors=[_BOX], fill_mode="solid"
                ),
            )
        for link in robot.links:
            self._dress(link)

    def show(self, frame: SceneFrame) -> None:
        """Write one moment; links that have not moved are left out."""
        self._at(frame.time_s)
        for name, shown in frame.boxes.items():
            if name not in self._poses:
                half_m = np.array(shown.size_m) / 2.0
                solid = self._rerun.Boxes3D(
                    half_sizes=[half_m], colors=[shown.colour], fill_mode="solid"
                )
                self._still(f"world/robot/{name}/box", solid)
        for name, pose in frame.link_poses.items():
            if name not in self._poses or np.abs(pose - self._poses[name]).max() > _MOVED:
                self._poses[name] = pose
                placed = self._rerun.Transform3D(
                    translation=pose[:3], quaternion=self._rerun.Quaternion(xyzw=pose[3:])
                )
                self._file.log(f"world/robot/{name}", placed)
        for number, cable_m in enumerate(frame.cables_m):
            path = f"world/cable_{number}" if number else "world/cable"
            self._line(path, [cable_m], frame.cable_radius_m, _CABLE)
        for name, overlay in overlay_changes(self._overlays, frame.overlays):
            self._overlay(f"world/overlays/{name}", overlay)
        self._overlays = frame.overlays
        if frame.trace_m is not None and frame.trace_m is not self._trace:
            self._trace = frame.trace_m
            self._line("world/trace", [frame.trace_m], _TRACE_RADIUS_M, _TRACE)
        if frame.camera is not None and frame.camera is not self._camera:
            self._camera = frame.camera
            self._line("world/camera", _sight(frame.camera), 0.001, _SIGHT)

    def image(self, name: str, time_s: float, png: bytes) -> None:
        """Write an image."""
        self._at(time_s)
        self._file.log(name, self._rerun.EncodedImage(contents=png, media_type="image/png"))

    def text(self, name: str, time_s: float, line: str) -> None:
        """Write a line of a log."""
        self._at(time_s)
        self._file.log(name, self._rerun.TextLog(line))

    def curve(self, name: str, times_s: Sequence[float], values: Sequence[float]) -> None:
        """Write a number over time."""
        times = self._rerun.TimeColumn(TIMELINE, duration=times_s)
        self._file.send_columns(name, [times], self._rerun.Scalars.columns(scalars=values))

    def _dress(self, link: Link) -> None:
        boxes = [shape for shape in link.shapes if isinstance(shape, Box)]
        capsules = [shape for shape in link.shapes if isinstance(shape, Capsule)]
        colour = [round(255 * part) for part in link.colour]
        path = f"world/robot/{link.name}"
        if boxes:
            low_m = np.array([box.low_m for box in boxes])
            high_m = np.array([box.high_m for box in boxes])
            solid = self._rerun.Boxes3D(
                centers=(low_m + high_m) / 2.0,
                half_sizes=(high_m - low_m) / 2.0,
                colors=[colour],
                fill_mode="solid",
            )
            self._still(f"{path}/boxes", solid)
        if capsules:
            starts_m = np.array([capsule.start_m for capsule in capsules])
            alongs_m = np.array([capsule.end_m for capsule in capsules]) - starts_m
            rounded = self._rerun.Capsules3D(
                translations=starts_m,
                lengths=np.linalg.norm(alongs_m, axis=1),
                radii=[capsule.radius_m for capsule in capsules],
                quaternions=[self._rerun.Quaternion(xyzw=_z_along(along)) for along in alongs_m],
                colors=[colour],
                fill_mode="solid",
            )
            self._still(f"{path}/capsules", rounded)

    def _line(
        self, path: str, strips_m: Sequence[Floats], radius_m: float, colour: tuple[int, int, int]
    ) -> None:
        drawn = self._rerun.LineStrips3D(strips_m, radii=[radius_m], colors=[colour])
        self._file.log(path, drawn)

    def _overlay(self, path: str, overlay: Overlay | None) -> None:
        """Write lines and dots; pictures are in a recording as images already."""
        match overlay:
            case Lines(segments_m, colours):
                drawn = self._rerun.LineStrips3D(segments_m, radii=[0.001], colors=colours)
            case Dots(points_m, colours, size_m):
                drawn = self._rerun.Points3D(points_m, radii=[0.5 * size_m], colors=colours)
            case Screen():
                return
            case None:
                drawn = self._rerun.Clear(recursive=False)
        self._file.log(path, drawn)

    def _still(self, path: str, what: object) -> None:
        self._file.log(path, what, static=True)

    def _at(self, time_s: float) -> None:
        self._file.set_time(TIMELINE, duration=time_s)


def _sight(camera: CameraCone) -> list[Floats]:
    """Return the edges of what a camera sees."""
    corners_m = camera.corners_m
    edges = [np.array([camera.position_m, corner]) for corner in corners_m]
    return [*edges, np.vstack([corners_m, corners_m[:1]])]


def _z_along(direction: Floats) -> Floats:
    """Return the quaternion xyzw that takes z to a direction."""
    if not direction.any():
        return np.array([0.0, 0.0, 0.0, 1.0])
    rotation, _ = Rotation.align_vectors([direction], [[0.0, 0.0, 1.0]])
    quat_xyzw: Floats = rotation.as_quat()
    return quat_xyzw
