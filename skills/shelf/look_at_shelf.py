"""Look into the shelf from one of the cell's viewpoints."""

from typing import Annotated

import numpy as np

from executive.core.outcome import failure, success
from executive.core.skill import In, Port, SkillRun
from perception.rgbd import RgbdCamera, RgbdFrame
from robots.shelf_tool import LookFrom, ShelfTool
from skills.looking import new_frame
from skills.shelf.tool_skill import MOTION_REASONS, ToolSkill, failed

# Less of the image with depth than this: something is before the camera, or it is broken.
LEAST_DEPTH = 0.2


class LookAtShelf(ToolSkill):
    """Take the camera to a viewpoint and take one frame in colour and depth.

    SUCCESS: `frame` is fresh.
    FAILURE: `camera.blind` when hardly any pixel has depth; `view.unknown` when the cell has no
        such viewpoint; a motion reason when the arm does not get there.
    stop(): the arm comes to rest.
    """

    OUT = {"frame": Port(RgbdFrame, "what the camera sees now")}
    REASONS = MOTION_REASONS | {"camera.blind", "view.unknown"}
    CLAIMS = frozenset({"tool", "camera"})

    def __init__(self, tool: ShelfTool, camera: RgbdCamera) -> None:
        """Bind the arm and the camera on it."""
        super().__init__(tool)
        self._camera = camera

    def run(
        self, viewpoint: Annotated[str, In("name of a viewpoint of the cell")] = "centre"
    ) -> SkillRun:
        """Go there, look."""
        if viewpoint not in self._tool.viewpoints:
            known = ", ".join(self._tool.viewpoints)
            return failure("view.unknown", f"no viewpoint {viewpoint!r} (known: {known})")
        result = yield from self._do(LookFrom(viewpoint))
        if result.failure is not None:
            return failed(result, viewpoint)
        frame = yield from new_frame(self._camera)
        share = float((~np.isnan(frame.depth_m)).mean())
        if share < LEAST_DEPTH:
            return failure("camera.blind", "hardly any pixel has depth", depth_share=share)
        return success(frame=frame)
