"""A detector that is told what each pixel shows, for experiments with nothing to detect."""

import numpy as np

from perception.rgbd import RgbdFrame
from perception.shelf.detections import Detections
from perception.shelf.types import NOTHING
from simulation.shelf_cell.physics import ShelfPhysics
from simulation.shelf_cell.seeing import see


class OracleDetector:
    """`perception.shelf.detections.ShelfDetector` by the world's own knowledge."""

    def __init__(self, physics: ShelfPhysics, names: tuple[str, ...]) -> None:
        """Bind the world, and the names that an object may have."""
        self._physics, self._names = physics, names

    def detect(self, frame: RgbdFrame) -> Detections:
        """Return all objects in view, as the world is now."""
        segments = see(self._physics, frame.camera).box
        shown = np.unique(segments[segments != NOTHING])
        # NOTHING, -1, finds the last entry.
        numbers = np.full(len(self._physics.box_names) + 1, NOTHING, dtype=np.int16)
        numbers[shown] = np.arange(len(shown))
        rows = np.zeros((len(shown), len(self._names)))
        for row, index in enumerate(shown.tolist()):
            rows[row, self._names.index(self._physics.box_names[index])] = 1.0
        return Detections(numbers[segments], self._names, rows)
