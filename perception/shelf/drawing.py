"""A look with the belief drawn over it, for recordings and for people."""

from collections.abc import Sequence

import numpy as np

from perception.rgbd import ColourImage
from perception.shelf.beliefs import SeenObject
from perception.shelf.types import Bools, Floats, Segments

HEAT = np.array([255.0, 40.0, 20.0])
TARGET = np.array([40, 255, 60], dtype=np.uint8)
UNSURE = np.array([255, 220, 40], dtype=np.uint8)
# Objects that are less sure than this are outlined as unsure.
SURE = 0.6
STRONGEST = 0.75


def drawn_belief(
    colour: ColourImage,
    segments: Segments,
    heat: Floats,
    objects: Sequence[SeenObject],
    target: str,
) -> ColourImage:
    """Lay the occupancy over a look in red, outline the target in green, the unsure in yellow.

    Args:
        colour: The look, shape (height, width, 3).
        segments: What each pixel shows, shape (height, width).
        heat: Occupancy, any scale, same shape.
        objects: What is seen.
        target: Name of the target.
    """
    share = STRONGEST * np.sqrt(heat / max(float(heat.max()), 1e-12))[..., None]
    grey = colour.astype(np.float64).mean(axis=2, keepdims=True)
    calm = 0.5 * colour + 0.5 * grey
    picture = ((1.0 - share) * calm + share * HEAT).astype(np.uint8)
    for one in objects:
        if one.number >= 0 and (one.label == target or one.certainty < SURE):
            rim = _outline(segments == one.number)
            picture[rim] = TARGET if one.label == target else UNSURE
    return picture


def _outline(mask: Bools) -> Bools:
    """Return the pixels of a mask that have a neighbour outside of it."""
    inner = mask.copy()
    for axis in (0, 1):
        for step in (-1, 1):
            inner &= np.roll(mask, step, axis=axis)
    return mask & ~inner
