"""A replay that opens offline: one HTML file with Meshcat's page, the scene and every frame."""

import base64
import html
import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import numpy as np
import umsgpack

from executive.core.errors import RecordingError
from robots.interfaces import Floats
from robots.viewer.frame import SceneFrame, overlay_changes, thinned
from robots.viewer.overlays import Overlay, draw_overlay
from robots.viewer.shapes import TUBE_SIDES
from robots.viewer.stage import (
    CABLE_POINTS,
    TRACE_POINTS,
    TRACE_RADIUS_M,
    Stage,
    draw_box,
    draw_cable,
    draw_camera,
    draw_trace,
)

# Frames are stored as 16-bit integers: lengths in tenths of a millimetre (up to 3.2 m away),
# quaternion parts in 1/32767.
METRE = 1e-4
_QUATERNION_ONE = 32767
_MAX_FRAMES = 2400


def write_html(
    stage: Stage,
    frames: Iterable[SceneFrame],
    path: Path,
    title: str = "Cellwright",
    rate_hz: float = 10.0,
) -> None:
    """Write a standalone replay with a time slider; about 1.1 kB a frame and 0.9 MB besides.

    Args:
        stage: The cell.
        frames: In order of time; all with the same number of cable points or more than
            `CABLE_POINTS`, or all without a cable, and all with the same boxes.
        path: The HTML file; its folder exists.
        title: Shown in the page.
        rate_hz: Frames kept a second; fewer when there would be more than 2400.

    Raises:
        RecordingError: There is no frame.
    """
    kept = _paced(frames, 1.0 / rate_hz)
    if not kept:
        raise RecordingError(
            f"{path}: nothing to show; got a recording without scene messages; "
            "expected at least one; try a mission on a simulated cell"
        )
    recording = {**_still(stage, kept), **_moving(stage, kept)}
    viewer, ours = files("meshcat") / "viewer/dist", files("robots.viewer")
    parts = {
        "title": html.escape(title),
        "recording": json.dumps(recording, separators=(",", ":")).replace("<", "\\u003c"),
        "licences": (viewer / "main.min.js.LICENSE.txt").read_text(encoding="utf-8"),
        "meshcat": (viewer / "main.min.js").read_text(encoding="utf-8"),
        "player": (ours / "player.js").read_text(encoding="utf-8"),
    }
    page = (ours / "page.html").read_text(encoding="utf-8")
    path.write_text(re.sub(r"\{\{(\w+)\}\}", lambda mark: parts[mark[1]], page), encoding="utf-8")


def _paced(frames: Iterable[SceneFrame], interval_s: float) -> list[SceneFrame]:
    """Keep the first and last frame, and between them one an interval.

    Where that is too many, every other one goes and the interval doubles.
    """
    kept: list[SceneFrame] = []
    last: SceneFrame | None = None
    for frame in frames:
        last = frame
        if kept and frame.time_s < kept[-1].time_s + interval_s - 1e-9:
            continue
        kept.append(frame)
        if len(kept) > _MAX_FRAMES:
            kept, interval_s = kept[::2], 2 * interval_s
    if last is not None and last is not kept[-1]:
        kept.append(last)
    return kept


def _still(stage: Stage, frames: Sequence[SceneFrame]) -> dict[str, object]:
    """Return what does not change: the commands that build the scene, and sizes.

    The cable and a trace are among them, as meshes that the player then bends, and the camera
    that looked first.
    """
    first = frames[0]
    cameras = [frame.camera for frame in frames if frame.camera is not None]
    commands = [*stage.commands(), *(draw_box(name, box) for name, box in first.boxes.items())]
    for number, cable_m in enumerate(first.cables_m):
        commands.append(draw_cable(cable_m, first.cable_radius_m, number))
    if first.cable_m is not None:
        commands.append(draw_trace(replace(first, trace_m=first.cable_m)))
    commands += draw_camera(cameras[0]) if cameras else ()
    return {
        "commands": [_text(umsgpack.packb(command.lower())) for command in commands],
        "metre": METRE,
        "sides": TUBE_SIDES,
        "cables": [min(len(cable_m), CABLE_POINTS) for cable_m in first.cables_m],
        "cable_radius": first.cable_radius_m,
        "trace_radius": TRACE_RADIUS_M,
    }


def _moving(stage: Stage, frames: Sequence[SceneFrame]) -> dict[str, object]:
    """Return the first time, all times from it on, poses and cable a frame, traces, captions."""
    known = {link.name for link in stage.robot.links if link.shapes} | frames[0].boxes.keys()
    links = sorted(known & frames[0].link_poses.keys())
    poses: dict[str, Floats] = {}
    rows = []
    for frame in frames:
        poses.update(frame.link_poses)
        cables = [_points(cable_m, CABLE_POINTS) for cable_m in frame.cables_m]
        rows.append(np.concatenate([_poses(poses, links), *cables]))
    times_s = [round(frame.time_s - frames[0].time_s, 3) for frame in frames]
    return {
        "start": frames[0].time_s,
        "times": times_s,
        "links": links,
        "width": len(rows[0]),
        "frames": _text(np.array(rows).astype("<i2").tobytes()),
        "traces": _traces(frames, times_s),
        "captions": _captions(frames, times_s),
        "overlays": _overlays(frames, times_s),
    }


def _poses(poses: Mapping[str, Floats], links: Sequence[str]) -> Floats:
    rows = np.array([poses[name] for name in links]).reshape(-1, 7)
    return _whole(np.hstack([rows[:, :3] / METRE, rows[:, 3:] * _QUATERNION_ONE]))


def _points(points_m: Floats | None, count: int) -> Floats:
    if points_m is None:
        return np.zeros(0)
    return _whole(thinned(points_m, count) / METRE)


def _whole(values: Floats) -> Floats:
    limit = np.iinfo(np.int16).max
    return np.clip(values.round(), -limit, limit).ravel()


def _traces(frames: Sequence[SceneFrame], times_s: Sequence[float]) -> list[tuple[float, str]]:
    changes: list[tuple[float, str]] = []
    shown: Floats | None = None
    for frame, time_s in zip(frames, times_s, strict=True):
        if frame.trace_m is not shown:
            points = _points(frame.trace_m, TRACE_POINTS)
            changes.append((time_s, _text(points.astype("<i2").tobytes())))
        shown = frame.trace_m
    return changes


def _overlays(
    frames: Sequence[SceneFrame], times_s: Sequence[float]
) -> dict[str, list[tuple[float, str]]]:
    """Return by name when each overlay changes, and the command that draws it anew."""
    changes: dict[str, list[tuple[float, str]]] = {}
    shown: Mapping[str, Overlay] = {}
    for frame, time_s in zip(frames, times_s, strict=True):
        for name, overlay in overlay_changes(shown, frame.overlays):
            command = umsgpack.packb(draw_overlay(name, overlay).lower())
            changes.setdefault(name, []).append((time_s, _text(command)))
        shown = frame.overlays
    return changes


def _captions(frames: Sequence[SceneFrame], times_s: Sequence[float]) -> list[tuple[float, str]]:
    changes: list[tuple[float, str]] = []
    for frame, time_s in zip(frames, times_s, strict=True):
        if not changes or changes[-1][1] != frame.caption:
            changes.append((time_s, frame.caption))
    return changes


def _text(content: bytes) -> str:
    return base64.b64encode(content).decode("ascii")
