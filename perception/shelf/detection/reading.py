"""Text in images, by whatever reads it; RapidOCR's models come inside its package."""

from dataclasses import dataclass
from importlib import import_module
from typing import Any, Protocol

import numpy as np

from executive.core.errors import InputError
from perception.rgbd import ColourImage
from perception.shelf.types import Floats

INSTALL = (
    "pip install 'cellwright[ocr]' && pip install --no-deps rapidocr-onnxruntime==1.4.4 "
    "(its own needs would replace opencv-python-headless)"
)
# Lines that the reader is less sure of are left out.
LEAST_CONFIDENCE = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class TextLine:
    """A line of text.

    Attributes:
        text: What it says.
        confidence: How sure the reader is, in [0, 1].
        corners_px: Corners (x, y), clockwise from the upper left, shape (4, 2).
    """

    text: str
    confidence: float
    corners_px: Floats

    @property
    def centre_px(self) -> Floats:
        """Middle (x, y), shape (2,)."""
        middle: Floats = self.corners_px.mean(axis=0)
        return middle

    @property
    def height_px(self) -> float:
        """Height of the line."""
        return float(np.linalg.norm(self.corners_px[3] - self.corners_px[0]))


class TextReader(Protocol):
    """Whatever reads text."""

    def read(self, image: ColourImage) -> tuple[TextLine, ...]:
        """Return the lines of an image, red, green and blue, shape (height, width, 3)."""
        ...


class RapidReader:
    """PP-OCRv4 by RapidOCR, on the processor, in one thread."""

    def __init__(self) -> None:
        """Load the models.

        Raises:
            InputError: RapidOCR is not installed.
        """
        try:
            # By name: what it needs cannot be asked for beside ours, see INSTALL.
            rapid = import_module("rapidocr_onnxruntime")
        except ImportError as error:
            raise InputError(
                f"reading labels: {error.name} is not installed; try: {INSTALL}"
            ) from error
        self._engine: Any = rapid.RapidOCR(
            intra_op_num_threads=1, inter_op_num_threads=1,
            det_limit_side_len=1600, det_limit_type="max",
        )  # fmt: skip

    def read(self, image: ColourImage) -> tuple[TextLine, ...]:
        """Return the lines of an image; see `TextReader`."""
        # RapidOCR takes blue first.
        found, _ = self._engine(np.ascontiguousarray(image[..., ::-1]), use_cls=False)
        lines = [
            TextLine(str(text), float(confidence), np.array(corners, dtype=np.float64))
            for corners, text, confidence in found or []
        ]
        return tuple(line for line in lines if line.confidence >= LEAST_CONFIDENCE)
