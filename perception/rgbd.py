"""Cameras that see colour and depth."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from perception.camera import CameraModel, DepthImage

ColourImage = NDArray[np.uint8]


@dataclass(frozen=True, slots=True, eq=False)
class RgbdFrame:
    """One look in colour and depth.

    Attributes:
        colour: Red, green and blue, shape (height, width, 3), uint8.
        depth_m: Distance along the view [m], shape (height, width), float32; NaN where unknown.
        stamp_s: When it was taken, on the cell's clock [s].
        camera: The camera that took it, with its pose; the world of a shelf cell is the shelf.
        viewpoint: Name of the viewpoint that it was taken from; empty where that has none.
    """

    colour: ColourImage
    depth_m: DepthImage
    stamp_s: float
    camera: CameraModel
    viewpoint: str = ""


@runtime_checkable
class RgbdCamera(Protocol):
    """A camera of a cell that sees colour and depth."""

    def capture(self) -> RgbdFrame:
        """Take a frame from where the camera is now.

        Raises:
            DeviceError: The camera moves, or gives no frame.
        """
        ...
