"""Notice cable that hangs over an arm."""

from typing import Annotated

import numpy as np

from executive.core.outcome import failure, success
from executive.core.skill import In, Skill, SkillRun
from executive.core.work import Worker
from perception.cable.interfaces import CableVision
from perception.camera import CameraFrame
from robots.interfaces import Floats

# Cable that lies over others is lower than this; what hangs over an arm at home is higher.
HANGS_M = 0.05
# So many pixels of it are no noise of the camera.
LEAST_PIXELS = 60


class CheckDrape(Skill):
    """Measure how high the cable in view lies, by the depth image.

    SUCCESS: all of it lies on the table.
    FAILURE: `cable.draped` when some of it is higher: it hangs over an arm.
    """

    REASONS = frozenset({"cable.draped"})

    def __init__(self, vision: CableVision, worker: Worker) -> None:
        """Bind perception, and who has the time for it."""
        self._vision, self._worker = vision, worker

    def run(self, frame: Annotated[CameraFrame, In("overhead frame, arms at home")]) -> SkillRun:
        """Look for cable that is too high."""
        heights_m = yield from self._worker.run(self._heights_m, frame)
        if int((heights_m > HANGS_M).sum()) < LEAST_PIXELS:
            return success()
        highest_m = float(np.percentile(heights_m, 99.9))
        return failure("cable.draped", "cable hangs over an arm", highest_m=highest_m)

    def _heights_m(self, frame: CameraFrame) -> Floats:
        """Return how high above the table the cable is that is in view, shape (N,)."""
        rows, columns = np.nonzero(self._vision.cable_pixels(frame.image))
        return heights_m(frame, np.column_stack([columns, rows]).astype(np.float64))


def heights_m(frame: CameraFrame, points_px: Floats) -> Floats:
    """Return heights above the table of image points, 0 where the depth is unknown.

    Args:
        frame: Overhead frame.
        points_px: Image points (x, y), shape (N, 2).
    """
    if not len(points_px):
        return np.zeros(0)
    columns, rows = np.rint(points_px).astype(int).T
    pose = frame.camera.T_world_camera
    table_m = (frame.camera.on_plane(points_px) - pose[:3, 3]) @ pose[:3, 2]
    heights: Floats = np.nan_to_num(table_m - frame.depth_m[rows, columns], nan=0.0)
    return heights
