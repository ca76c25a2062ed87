"""Notice cable that hangs over an arm."""

from typing import Annotated

import numpy as np

from executive.core.outcome import failure, success
from executive.core.skill import In, Skill, SkillRun
from executive.core.work import Worker
from perception.cable.interfaces import CableVision
from perception.camera import CameraFrame
from robots.interfaces import Floats
from skills.cable.heights import heights_m

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
