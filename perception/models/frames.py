"""Images scaled to the width of the cable, and crops turned to its direction."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from perception.camera import GreyImage

Floats = NDArray[np.float64]
Crop = NDArray[np.float32]
_SHIFT = 3


@dataclass(frozen=True, slots=True, eq=False)
class ScaledImage:
    """An image in which cables have the width that a network knows.

    Attributes:
        pixels: Grey values, shape (H, W).
        scale: Its size, in its own units, over that of the original.
        fill: Grey value beyond its border.
        zoom: Pixels a unit, along each axis.
    """

    pixels: GreyImage
    scale: float
    fill: float
    zoom: float = 1.0

    @property
    def size(self) -> Floats:
        """Width and height [units], shape (2,)."""
        return np.array(self.pixels.shape[::-1]) / self.zoom

    def into(self, points_px: Floats) -> Floats:
        """Return points of the original image in this one; centres of units are whole numbers."""
        return (points_px + 0.5) * self.scale - 0.5

    def back(self, points: Floats) -> Floats:
        """Return points of this image in the original one."""
        return (points + 0.5) / self.scale - 0.5

    def holds(self, point: Floats) -> bool:
        """Say whether a point of this image lies within it."""
        return bool((point >= 0.0).all() and (point < self.size).all())


def scale_image(image: GreyImage, width_px: float, wanted: float, zoom: float = 1.0) -> ScaledImage:
    """Scale an image so that a cable of `width_px` pixels becomes `wanted` units wide.

    Args:
        image: Grey image.
        width_px: Width of the cable in it.
        wanted: Width that the network knows.
        zoom: Pixels a unit; more than one keep detail of the original.
    """
    scale = wanted / width_px
    how = cv2.INTER_AREA if zoom * scale < 1.0 else cv2.INTER_LINEAR
    pixels = cv2.resize(image, None, fx=zoom * scale, fy=zoom * scale, interpolation=how)
    grey = pixels.astype(np.uint8)
    return ScaledImage(grey, scale, float(np.median(grey[::4, ::4])), zoom)


@dataclass(frozen=True, slots=True, eq=False)
class CropFrame:
    """Where a crop lies: `points_crop = turn @ points_image + shift`.

    Attributes:
        turn: Rotation, shape (2, 2).
        shift: Translation [crop pixels], shape (2,).
    """

    turn: Floats
    shift: Floats

    def into(self, points: Floats) -> Floats:
        """Return points of the scaled image in crop pixels."""
        moved: Floats = points @ self.turn.T + self.shift
        return moved

    def back(self, points_crop: Floats) -> Floats:
        """Return points of the crop in scaled image pixels."""
        moved: Floats = (points_crop - self.shift) @ self.turn
        return moved


def turned_frame(here: Floats, heading: Floats, place: tuple[float, float]) -> CropFrame:
    """Return the frame with `here` at `place` and `heading` (a unit vector) to the right."""
    turn = np.array([[heading[0], heading[1]], [-heading[1], heading[0]]])
    return CropFrame(turn, np.asarray(place) - turn @ here)


def cut(scaled: ScaledImage, frame: CropFrame, size: int) -> Crop:
    """Return the grey values of a square crop, `size` units wide, as finely as they are known."""
    size_px = round(size * scaled.zoom)
    # Pixels have their centres at ((k + 0.5) / zoom - 0.5) units, in image and crop.
    middle = 0.5 * (scaled.zoom - 1.0)
    shift_px = scaled.zoom * frame.shift + middle - frame.turn @ np.array([middle, middle])
    grey = cv2.warpAffine(
        scaled.pixels,
        np.column_stack([frame.turn, shift_px]),
        (size_px, size_px),
        flags=cv2.INTER_LINEAR,
        borderMode=cv2.BORDER_CONSTANT,
        borderValue=scaled.fill,
    )
    return grey.astype(np.float32)


def draw_line(canvas: GreyImage, points_crop: Floats, level: int, thickness_px: int) -> None:
    """Draw a smooth-edged polyline, in place."""
    fixed = np.round(points_crop * (1 << _SHIFT)).astype(np.int32)
    cv2.polylines(canvas, [fixed[:, None]], False, level, thickness_px, cv2.LINE_AA, _SHIFT)
