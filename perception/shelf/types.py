"""What shelf perception speaks of.

The shelf's frame: origin at the front left lower corner of the inside as the camera sees it, x
along the shelf, y into it, z up. Objects are cuboids with their faces along the axes, as in the
thesis (section 5.2). They stand on the floor of the shelf, or one of them on another.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from perception.camera import CameraModel, DepthImage

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
Segments = NDArray[np.int16]
Size = tuple[float, float, float]

# What lies on another box begins where that ends, give or take so much.
LEVEL_M = 0.02
# Objects that touch do not collide.
TOUCH_M = 1e-6
# What a segmentation image holds where no object is.
NOTHING = -1


@dataclass(frozen=True, slots=True)
class Shelf:
    """The inside of a shelf that is open at its front; defaults of the thesis, section 7.2.

    Attributes:
        width_m: Along x.
        depth_m: Along y.
        height_m: Along z.
    """

    width_m: float = 0.8
    depth_m: float = 0.35
    height_m: float = 0.57


@dataclass(frozen=True, slots=True)
class Box:
    """A cuboid that stands on the shelf.

    Attributes:
        x_m: Centre along the shelf.
        y_m: Centre into the shelf.
        size_m: Width (x), depth (y) and height (z).
        bottom_m: Height of its lower side above the floor; 0 unless it stands on another one.
    """

    x_m: float
    y_m: float
    size_m: Size
    bottom_m: float = 0.0

    @property
    def low_m(self) -> Size:
        """Lower corner (x, y, z)."""
        return (self.x_m - 0.5 * self.size_m[0], self.y_m - 0.5 * self.size_m[1], self.bottom_m)

    @property
    def high_m(self) -> Size:
        """Upper corner (x, y, z)."""
        return (
            self.x_m + 0.5 * self.size_m[0],
            self.y_m + 0.5 * self.size_m[1],
            self.bottom_m + self.size_m[2],
        )

    def at(self, x_m: float, y_m: float) -> "Box":
        """Return the same box elsewhere, at the same height."""
        return Box(x_m, y_m, self.size_m, self.bottom_m)

    def on_floor(self, x_m: float, y_m: float) -> "Box":
        """Return the same box elsewhere on the floor."""
        return Box(x_m, y_m, self.size_m)


def corners(boxes: "list[Box] | tuple[Box, ...]") -> tuple[Floats, Floats]:
    """Return lower and upper corners [m], shape (N, 3) each."""
    low_m = np.array([box.low_m for box in boxes], dtype=np.float64).reshape(-1, 3)
    high_m = np.array([box.high_m for box in boxes], dtype=np.float64).reshape(-1, 3)
    return low_m, high_m


def stands_on(upper: Box, lower: Box) -> bool:
    """Say whether a box stands on another one, as far as places are known."""
    if upper.bottom_m == 0.0 or abs(upper.bottom_m - lower.high_m[2]) > LEVEL_M:
        return False
    wide = min(upper.high_m[0], lower.high_m[0]) - max(upper.low_m[0], lower.low_m[0])
    deep = min(upper.high_m[1], lower.high_m[1]) - max(upper.low_m[1], lower.low_m[1])
    return wide > TOUCH_M and deep > TOUCH_M


@dataclass(frozen=True, slots=True, eq=False)
class ShelfView:
    """One look into a shelf, with what a detector has made of it.

    Attributes:
        depth_m: Distance along the view [m], shape (height, width); NaN where unknown.
        segments: Which object each pixel shows, as an index of `labels`, or `NOTHING`.
        labels: Names of the objects in view.
        camera: The camera that took it; its world frame is the shelf's.
    """

    depth_m: DepthImage
    segments: Segments
    labels: tuple[str, ...]
    camera: CameraModel


@dataclass(frozen=True, slots=True, eq=False)
class Sighting:
    """One object in a view.

    Attributes:
        label: Its name.
        mask: Pixels that show it, shape (height, width).
        box: Where it stands, as far as its known size completes what is seen.
        sure: The part of that box that is there whatever is hidden of it.
        loose_m: How far along x and y the box may stand elsewhere, to either side.
    """

    label: str
    mask: Bools
    box: Box
    sure: Box
    loose_m: tuple[float, float] = (0.0, 0.0)
