"""Find the objects in a look, and what they may be."""

from typing import Annotated

from executive.core.outcome import failure, success
from executive.core.skill import In, Port, Skill, SkillRun
from executive.core.work import Worker
from perception.rgbd import RgbdFrame
from perception.shelf.detections import Detections, ShelfDetector


class DetectObjects(Skill):
    """Segment a frame into objects and read their names, with how sure each reading is.

    SUCCESS: `detections` holds at least one object.
    FAILURE: `shelf.empty` when nothing stands out from the walls.
    """

    OUT = {"detections": Port(Detections, "objects in the frame and what they may be")}
    REASONS = frozenset({"shelf.empty"})

    def __init__(self, detector: ShelfDetector, worker: Worker) -> None:
        """Bind the detector, and who has the time for it."""
        self._detector, self._worker = detector, worker

    def run(self, frame: Annotated[RgbdFrame, In("look into the shelf")]) -> SkillRun:
        """Detect."""
        detections = yield from self._worker.run(self._detector.detect, frame)
        if detections.count == 0:
            return failure("shelf.empty", "nothing stands out from the walls")
        return success(detections=detections)
