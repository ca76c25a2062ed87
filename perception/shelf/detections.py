"""What a detector says about an image of a shelf, and who may be one."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from perception.rgbd import RgbdFrame
from perception.shelf.types import Floats, Segments

# A probability below counts as this one: no reading is that sure.
LEAST = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Detections:
    """Objects in an image, and what they may be.

    Attributes:
        segments: Which object each pixel shows, by number, or `NOTHING`; shape (height, width).
        names: Names that an object may have.
        probabilities: Of each object, by number, to have each name, shape (K, N); a row may add up
            to less than 1, and the rest is for what has none of the names.
    """

    segments: Segments
    names: tuple[str, ...]
    probabilities: Floats

    @property
    def count(self) -> int:
        """Number of objects."""
        return len(self.probabilities)


@runtime_checkable
class ShelfDetector(Protocol):
    """Finds objects in an image of a shelf and reads what they are."""

    def detect(self, frame: RgbdFrame) -> Detections:
        """Return all objects in view."""
        ...


def entropy_bits(probabilities: Floats) -> Floats:
    """Return the entropy of each row [bit], what has no name as one more case, shape (K,)."""
    rest = np.maximum(1.0 - probabilities.sum(axis=1, keepdims=True), 0.0)
    cases = np.maximum(np.hstack([probabilities, rest]), LEAST)
    bits: Floats = -(cases * np.log2(cases)).sum(axis=1)
    return bits
