"""Shows a run on a simulated cell: live in a browser, or as a replay made from its recording."""

import logging
from collections.abc import Mapping, Sequence
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from pydantic import BaseModel

from executive.app.scenes import SCENE_TOPIC, SHELF_EYE, SHOWN_TYPES, SceneFollower, scene_frames
from executive.core.errors import DeviceError
from executive.core.world import StreamMessage
from executive.engine.recording.reader import Recording
from executive.engine.recording.values import ValueEncoder
from executive.engine.ticks import Tick
from robots.descriptions import DESCRIPTIONS
from robots.descriptions.yumi import yumi
from robots.placement import table_scene
from robots.shelf_arm.scene import ROBOT, ShelfSize, open_scene
from robots.viewer import LiveViewer, Stage
from robots.viewer import write_html as write_page
from robots.viewer.rerun_file import RerunFile, need_rerun

_JOINT_STATES_TOPIC = "/joint_states"
_SHELF_WORLD = "shelf_cell"

_log = logging.getLogger(__name__)


class _JointStates(BaseModel):
    """A message of the stream of joint states; see `simulation.streams`."""

    names: tuple[str, ...] = ()
    positions: tuple[float, ...] = ()


class LiveView:
    """An observer of a run that shows it in a browser."""

    def __init__(self, world: str) -> None:
        """Start the viewer for a cell of that world.

        Raises:
            DeviceError: It does not start.
        """
        self._viewer = LiveViewer(_stage(world))
        self._pictures: list[bytes] = []
        self._follower = SceneFollower(png_of=self._pictures.__getitem__)
        self._encoder = ValueEncoder(store_image=self._keep)
        self._alive = True

    @property
    def url(self) -> str:
        """Where to look."""
        return self._viewer.url

    def on_tick(self, tick: Tick) -> None:
        """Take what a tick wrote that can be seen."""
        shown = [write for write in tick.writes if isinstance(write.value, SHOWN_TYPES)]
        self._pictures.clear()
        writes = tuple(replace(each, value=self._encoder.encode(each.value)) for each in shown)
        self._follower.on_tick(replace(tick, writes=writes))

    def on_streams(self, messages: Sequence[StreamMessage]) -> None:
        """Show the latest scene; a viewer that breaks goes dark, and the run goes on."""
        for message in messages:
            self._follower.on_stream(message)
        scenes = [message for message in messages if message.topic == SCENE_TOPIC]
        if not scenes or not self._alive:
            return
        frame = self._follower.frame(scenes[-1].time_s)
        try:
            if frame is not None:
                self._viewer.show(frame)
        except DeviceError as error:
            self._alive = False
            _log.warning("%s", error)

    def _keep(self, image: NDArray[np.uint8]) -> int:
        """Keep an image of the tick; return its number."""
        file = BytesIO()
        Image.fromarray(image).save(file, format="PNG")
        self._pictures.append(file.getvalue())
        return len(self._pictures) - 1

    def close(self) -> None:
        """End the viewer."""
        self._viewer.close()


def open_live_view(world: str) -> LiveView:
    """Start a live view of a cell, by the name of its world.

    Raises:
        DeviceError: The viewer does not start.
    """
    return LiveView(world)


def write_html(recording: Path, page: Path) -> None:
    """Write the replay of a recording as one HTML file that opens offline.

    Raises:
        RecordingError: The recording cannot be read, or holds no scene.
    """
    run = Recording.open(recording)
    title = f"{run.header.mission}, seed {run.header.seed}"
    write_page(_stage(_world(run)), scene_frames(run), page, title=title)


def write_rerun(recording: Path, file: Path) -> None:
    """Write a recording as a file for the Rerun viewer: scene, images, joints, what was done.

    Raises:
        InputError: The package for it is not installed.
        RecordingError: The recording cannot be read, or the file not be written.
    """
    need_rerun("--rerun")
    run = Recording.open(recording)
    with RerunFile(file, f"{run.header.mission}, seed {run.header.seed}") as drawn:
        stage = _stage(_world(run))
        drawn.set_stage(stage.robot, stage.scene)
        doing = ""
        for frame in scene_frames(run):
            drawn.show(frame)
            if frame.caption != doing:
                doing = frame.caption
                drawn.text("doing", frame.time_s, doing)
        for image in run.images():
            drawn.image("image", image.time_s, image.png)
        for name, rows in _joint_curves(run).items():
            drawn.curve(f"joints/{name}", *zip(*rows, strict=True))


def _joint_curves(run: Recording) -> Mapping[str, Sequence[tuple[float, float]]]:
    """Return time and position of each joint, in the order of time."""
    curves: dict[str, list[tuple[float, float]]] = {}
    for message in run.streams():
        if message.topic == _JOINT_STATES_TOPIC:
            joints = _JointStates.model_validate_json(message.data)
            for name, position in zip(joints.names, joints.positions, strict=True):
                curves.setdefault(name, []).append((message.time_s, position))
    return curves


def _world(run: Recording) -> str:
    return str(run.header.cell.get("world", ""))


def _stage(world: str) -> Stage:
    """Return what stands still in a world; worlds that show nothing get the table's."""
    if world != _SHELF_WORLD:
        return Stage(yumi(), table_scene())
    scene = open_scene(ShelfSize())
    walls = frozenset({"shelf_top", "left_wall", "right_wall"})
    return Stage(DESCRIPTIONS[ROBOT](), scene, SHELF_EYE, walls)
