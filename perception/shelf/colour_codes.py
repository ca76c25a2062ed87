"""Objects found and named by the colours of their boxes.

It stands in for a detector of real products where each product has a colour of its own. It knows
nothing but the image and the stock's colours, and declares how unsure it is: few pixels, noise and
colours that are alike make rows of probabilities flat.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label, uniform_filter

from perception.camera import CameraModel
from perception.rgbd import ColourImage, RgbdFrame
from perception.shelf.casting import BoxCaster
from perception.shelf.detections import Detections
from perception.shelf.stock import Stock
from perception.shelf.types import NOTHING, Bools, Floats, Shelf

# Spread of directions of colours of one product, by noise.
SPREAD = 0.04
# A colour farther from all of the stock than so many spreads is that of an unknown object.
STRANGE = 5.0
# Less than this before the walls is a wall.
WALL_M = 0.008
# Smaller patches are noise.
LEAST_PX = 4
# So many pixels' worth of doubt go into each reading.
DOUBT_PX = 1.5
# Pixels darker than this have no colour to speak of.
DARK = 12.0


class ColourCodeDetector:
    """Reads products by colour."""

    def __init__(self, stock: Stock) -> None:
        """Take the colours of the stock."""
        self._stock = stock
        colours = np.array([product.colour for product in stock.products], dtype=np.float64)
        self._directions = colours / np.linalg.norm(colours, axis=1, keepdims=True)

    def detect(self, frame: RgbdFrame) -> Detections:
        """Return what stands out from the walls, one object for each colour."""
        things = _in_front(frame.depth_m, self._stock.shelf, frame.camera)
        posteriors = self._posteriors(frame.colour)
        smooth = uniform_filter(posteriors * things[..., None], size=(3, 3, 1))
        picked = np.where(things, smooth.argmax(axis=2), NOTHING)
        segments = np.full(things.shape, NOTHING, dtype=np.int16)
        rows: list[Floats] = []
        count = len(self._stock.products)
        for name in range(count):
            patch = _patches(picked == name)
            if patch.any():
                segments[patch] = len(rows)
                rows.append(_reading(posteriors[patch], count))
        # What has no colour of the stock is as many objects as there are patches of it.
        for patch in _each(picked == count):
            segments[patch] = len(rows)
            rows.append(_reading(posteriors[patch], count))
        return Detections(segments, self._stock.names, np.array(rows).reshape(-1, count))

    def _posteriors(self, colour: ColourImage) -> Floats:
        """Return P(product) of each pixel and, last, P(none), shape (height, width, N + 1)."""
        bright = np.linalg.norm(colour.astype(np.float64), axis=2, keepdims=True)
        apart = 1.0 - (colour / np.maximum(bright, DARK)) @ self._directions.T
        logs = -apart / SPREAD**2
        strange = np.full((*logs.shape[:2], 1), -0.5 * STRANGE**2)
        logs = np.concatenate([logs, strange], axis=2)
        odds = np.exp(logs - logs.max(axis=2, keepdims=True))
        posteriors: Floats = odds / odds.sum(axis=2, keepdims=True)
        return posteriors


def _in_front(depth_m: NDArray[np.float32], shelf: Shelf, camera: CameraModel) -> Bools:
    """Say which pixels show something that is nearer than the walls, inside the shelf."""
    caster = BoxCaster(camera)
    size_m = np.array([shelf.width_m, shelf.depth_m, shelf.height_m])
    enter_m, leave_m = caster.inside(np.zeros(3), size_m)
    return np.asarray((depth_m < leave_m - WALL_M) & (depth_m > enter_m - WALL_M))


def _patches(pixels: Bools) -> Bools:
    """Return pixels without small patches."""
    numbers, _ = label(pixels)
    sizes = np.bincount(numbers.ravel())
    sizes[0] = 0
    return np.asarray(sizes[numbers] >= LEAST_PX)


def _each(pixels: Bools) -> list[Bools]:
    """Return the patches one by one."""
    numbers, count = label(_patches(pixels))
    return [numbers == number for number in range(1, count + 1)]


def _reading(posteriors: Floats, count: int) -> Floats:
    """Return P(name) of an object from those of its pixels, shape (count,)."""
    even = np.full(count + 1, 1.0 / (count + 1))
    mixed: Floats = (posteriors.sum(axis=0) + DOUBT_PX * even) / (len(posteriors) + DOUBT_PX)
    return mixed[:count]
