"""What a simulated cell looks like at a moment of a run, put together from its messages.

Live views and replays follow the same messages in their recorded form, so they show the same.
What perception believes in pixels is laid on the table here, where cameras and robots may both
be known.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from pydantic import BaseModel

from executive.app.overlays import (
    Pictures,
    encoded_array,
    picture_overlay,
    plan_overlay,
    target_overlay,
)
from executive.core.world import StreamMessage
from executive.engine.recording.messages import RecordedNode
from executive.engine.recording.reader import Recording
from executive.engine.ticks import NodeStatus, Tick
from perception.cable.types import Trace
from perception.camera import CameraFrame, CameraModel
from perception.shelf.beliefs import ShelfBelief
from robots.interfaces import Floats
from robots.viewer import CameraCone, Eye, SceneFrame, ShownBox
from robots.viewer.overlays import Overlay
from robots.viewer.stage import TABLE_EYE

SCENE_TOPIC = "/scene"
_PLAN_TOPIC = "/plan"
_SHELF_SCHEMA = "ShelfScene"
# From before the shelf, over the arm's left shoulder.
SHELF_EYE = Eye((-1.0, -1.85, 1.1), (0.4, -0.3, 0.0))
# Where the latest picture stands: behind the table, and beside the shelf.
TABLE_SCREEN_M, SHELF_SCREEN_M, SCREEN_WIDTH_M = (-0.95, -0.55, 0.2), (1.45, 0.25, 0.35), 0.6
_BELIEF_KEY = ":knotted_probability"
SHOWN_TYPES = (Trace, CameraFrame, ShelfBelief, float)
"""Types of the values that a scene is made of, beside the messages of streams."""


class _Array(BaseModel):
    values: list[Any]


class _Tuple(BaseModel):
    items: list[float]


class _Scene(BaseModel):
    """A message of the scene stream; see `simulation.streams`."""

    links: dict[str, list[float]]
    cable_nodes_m: list[list[float]]
    cable_radius_m: float
    more_cables_m: list[list[list[float]]] = []


class _ShelfScene(BaseModel):
    """A message of the scene stream; see `simulation.shelf_cell.streams`."""

    links: dict[str, list[float]]
    boxes: dict[str, list[float]]
    sizes_m: dict[str, tuple[float, float, float]]
    colours: dict[str, tuple[int, int, int]]


class _Camera(BaseModel):
    """A `CameraModel` as recordings hold it."""

    width_px: int
    height_px: int
    focal_px: float
    centre_px: _Tuple
    T_world_camera: _Array

    def model(self) -> CameraModel:
        """Return the camera itself."""
        x_px, y_px = self.centre_px.items
        T_world_camera = np.array(self.T_world_camera.values)
        return CameraModel(
            self.width_px, self.height_px, self.focal_px, (x_px, y_px), T_world_camera
        )


class SceneFollower:
    """Puts together what a scene looks like from the messages of a run, one after another."""

    def __init__(
        self,
        nodes: Sequence[RecordedNode] = (),
        png_of: Callable[[int], bytes | None] = lambda _: None,
    ) -> None:
        """Begin before the first message.

        Args:
            nodes: The table that ticks refer to.
            png_of: Returns an image by the number that values refer to it by.
        """
        self._png_of = png_of
        self._overlays: dict[str, Overlay] = {}
        parents = {node.parent for node in nodes}
        self._leaves = {i: node.name for i, node in enumerate(nodes) if i not in parents}
        self._scene: StreamMessage | None = None
        self._camera: CameraModel | None = None
        self._cone: CameraCone | None = None
        self._trace_m: Floats | None = None
        self._doing = ""
        self._belief = ""

    def on_stream(self, message: StreamMessage) -> None:
        """Take a message of the scene, or of the plan that is carried out."""
        if message.topic == SCENE_TOPIC:
            self._scene = message
        elif message.topic == _PLAN_TOPIC:
            self._lay("plan", plan_overlay(message.data))

    def on_tick(self, tick: Tick) -> None:
        """Take a tick; values are in their JSON form."""
        for node, status in tick.changes:
            if status is NodeStatus.RUNNING and node in self._leaves:
                self._doing = self._leaves[node]
        for write in tick.writes:
            self._look_at(write.key, write.value)

    def frame(self, time_s: float) -> SceneFrame | None:
        """Return the scene as it is now known; None before its first message."""
        if self._scene is None:
            return None
        frame = _shelf_frame if self._scene.schema == _SHELF_SCHEMA else _table_frame
        return replace(
            frame(self._scene.data, time_s),
            trace_m=self._trace_m,
            camera=self._cone,
            caption=" · ".join(part for part in (self._doing, self._belief) if part),
            overlays=dict(self._overlays),
        )

    def _lay(self, name: str, overlay: Overlay | None) -> None:
        if overlay is None:
            self._overlays.pop(name, None)
        else:
            self._overlays[name] = overlay

    def _show(self, image: Mapping[str, Any]) -> None:
        """Stand the picture that a value refers to in the scene."""
        shelf = self._scene is not None and self._scene.schema == _SHELF_SCHEMA
        png = self._png_of(int(image.get("image", -1)))
        if png is not None:
            screen, eye = (SHELF_SCREEN_M, SHELF_EYE) if shelf else (TABLE_SCREEN_M, TABLE_EYE)
            self._lay("picture", picture_overlay(png, np.array(screen), eye, SCREEN_WIDTH_M))

    def _believe(self, value: Mapping[str, Any]) -> None:
        places_m, weights = (encoded_array(value[name]) for name in ("places_m", "weights"))
        if places_m is not None and weights is not None:
            self._lay("target", target_overlay(places_m.reshape(-1, 2), weights))
        self._show(value["picture"])

    def _look_at(self, key: str, value: Any) -> None:
        if isinstance(value, float) and key.endswith(_BELIEF_KEY):
            self._belief = f"P(knotted) {value:.2f}"
        if not isinstance(value, dict):
            return
        if value.get("$type") == _type_name(CameraFrame):
            self._see_through(_Camera.model_validate(value["camera"]).model())
            self._show(value["image"])
        elif value.get("$type") == _type_name(ShelfBelief):
            self._believe(value)
        elif value.get("$type") == _type_name(Trace) and self._camera is not None:
            points_px = np.array(_Array.model_validate(value["points_px"]).values)
            self._trace_m = self._camera.on_plane(points_px)

    def _see_through(self, camera: CameraModel) -> None:
        self._camera = camera
        right_px, bottom_px = camera.width_px - 0.5, camera.height_px - 0.5
        corners_px = np.array(
            [[-0.5, -0.5], [right_px, -0.5], [right_px, bottom_px], [-0.5, bottom_px]]
        )
        if self._cone is None:
            self._cone = CameraCone(camera.T_world_camera[:3, 3], camera.on_plane(corners_px))


def _table_frame(data: bytes, time_s: float) -> SceneFrame:
    scene = _Scene.model_validate_json(data)
    return SceneFrame(
        time_s,
        _arrays(scene.links),
        np.array(scene.cable_nodes_m),
        scene.cable_radius_m,
        more_cables_m=tuple(np.array(line) for line in scene.more_cables_m),
    )


def _shelf_frame(data: bytes, time_s: float) -> SceneFrame:
    scene = _ShelfScene.model_validate_json(data)
    boxes = {name: ShownBox(scene.sizes_m[name], scene.colours[name]) for name in scene.boxes}
    return SceneFrame(time_s, _arrays({**scene.links, **scene.boxes}), boxes=boxes)


def _arrays(poses: Mapping[str, list[float]]) -> dict[str, Floats]:
    return {name: np.array(pose) for name, pose in poses.items()}


def scene_frames(recording: Recording) -> Iterator[SceneFrame]:
    """Yield the scene as it was known at every tick of a recording."""
    follower = SceneFollower(recording.header.nodes, Pictures(recording).png)
    messages = iter(recording.streams())
    message = next(messages, None)
    for tick in recording.ticks():
        while message is not None and message.time_s <= tick.time_s:
            follower.on_stream(message)
            message = next(messages, None)
        follower.on_tick(tick)
        frame = follower.frame(tick.time_s)
        if frame is not None:
            yield frame


def _type_name(kind: type) -> str:
    """Return the name that recordings give a type."""
    return f"{kind.__module__}.{kind.__qualname__}"
