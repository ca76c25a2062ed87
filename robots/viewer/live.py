"""A live view in the browser, by way of Meshcat's own small server."""

import atexit
import subprocess
import sys
import time
from collections.abc import Mapping
from typing import Any

import numpy as np
import umsgpack
import zmq

from executive.core.errors import DeviceError
from robots.interfaces import Floats
from robots.viewer.frame import CameraCone, SceneFrame, overlay_changes
from robots.viewer.overlays import Overlay, draw_overlay
from robots.viewer.stage import Stage, draw_box, draw_cable, draw_camera, draw_trace, move_link

SERVER_COMMAND = (sys.executable, "-u", "-m", "meshcat.servers.zmqserver")
_ANSWER_MS = 5_000
_MOVED = 1e-5  # metres, or parts of a unit quaternion


class LiveViewer:
    """Shows a cell while it runs; open `url` in a browser, before or while frames come.

    The server is a process of its own, which `close` ends. Meshcat's Python client is not
    used because it prints to standard output, which belongs to `run --json`.
    """

    def __init__(self, stage: Stage, min_interval_s: float = 0.05) -> None:
        """Start the server and draw what stands still.

        Args:
            stage: The cell.
            min_interval_s: A frame that comes sooner after the last one is not drawn [s].

        Raises:
            DeviceError: The server does not start.
        """
        self._min_interval_s = min_interval_s
        self._last_s = -np.inf
        self._poses: dict[str, Floats] = {}
        self._boxes: set[str] = set()
        self._trace: Floats | None = None
        self._overlays: Mapping[str, Overlay] = {}
        self._camera: CameraCone | None = None
        self._server = subprocess.Popen(
            SERVER_COMMAND, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
            start_new_session=True,  # Ctrl-C stops the run first; the run closes the viewer
        )  # fmt: skip
        atexit.register(self.close)
        self._context = zmq.Context()
        self._socket = self._context.socket(zmq.REQ)
        try:
            self._socket.connect(self._announced("zmq_url"))
            self.url = self._announced("web_url")
            self._socket.setsockopt(zmq.RCVTIMEO, _ANSWER_MS)
            for command in stage.commands():
                self._send(command)
        except BaseException:
            self.close()
            raise

    def show(self, frame: SceneFrame) -> None:
        """Draw a frame, unless one was drawn just before.

        Raises:
            DeviceError: The server does not answer any more.
        """
        now_s = time.monotonic()  # frames are for eyes: the machine's time, not the cell's
        if now_s - self._last_s < self._min_interval_s:
            return
        self._last_s = now_s
        for name, box in frame.boxes.items():
            if name not in self._boxes:
                self._send(draw_box(name, box))
                self._boxes.add(name)
        for name, pose in frame.link_poses.items():
            if name not in self._poses or np.abs(pose - self._poses[name]).max() > _MOVED:
                self._send(move_link(name, pose))
                self._poses[name] = pose
        for number, cable_m in enumerate(frame.cables_m):
            self._send(draw_cable(cable_m, frame.cable_radius_m, number))
        for name, overlay in overlay_changes(self._overlays, frame.overlays):
            self._send(draw_overlay(name, overlay))
        self._overlays = frame.overlays
        if frame.trace_m is not self._trace:
            self._send(draw_trace(frame))
            self._trace = frame.trace_m
        if frame.camera is not None and frame.camera is not self._camera:
            for command in draw_camera(frame.camera):
                self._send(command)
            self._camera = frame.camera

    def close(self) -> None:
        """End the server; safe to call again."""
        atexit.unregister(self.close)
        self._context.destroy(linger=0)
        self._server.kill()
        self._server.wait()
        if self._server.stdout is not None:
            self._server.stdout.close()

    def _announced(self, name: str) -> str:
        """Return an address that the server prints when it starts."""
        assert self._server.stdout is not None
        line = self._server.stdout.readline().strip()
        key, _, address = line.partition("=")
        if key != name:
            raise DeviceError(
                f"viewer: Meshcat's server did not start; got {line or 'no answer'!r}, expected "
                f"{name}; try: {' '.join(SERVER_COMMAND)} to see why, or run without --view"
            )
        return address

    def _send(self, command: Any) -> None:
        content = command.lower()
        parts = (content["type"].encode(), content["path"].encode(), umsgpack.packb(content))
        try:
            self._socket.send_multipart(parts)
            self._socket.recv()
        except zmq.ZMQError as error:
            raise DeviceError(
                f"viewer: Meshcat's server at {self.url} does not answer ({error}); "
                "try: run without --view, and look at the replay"
            ) from error
