"""The cable's width, and its pixels, whichever of cable and table is the brighter."""

from collections.abc import Sequence

import cv2
import numpy as np

from perception.cable.mask import CableMask, find_mask
from perception.cable.polyline import arc_lengths, pixels_of, point_at
from perception.cable.tracers.centre_line import tangents
from perception.cable.types import Points
from perception.camera import GreyImage

# How far to either side of a line its profile is looked at, and where only table is seen.
REACH_PX, TABLE_PX = 20.0, 12.0
FINE_PX = 0.25
# The line may lie so far off the cable's middle.
ASIDE_PX = 2.0
# At a cable's border, blurred or not, the profile has sunk to this share.
BORDER = 0.5
# A profile must rise above its own noise by this factor, and by so many grey values.
CLEAR, LEAST = 4.0, 8.0
# Lines are looked at in pieces of this length; a typical width takes at least so many.
PIECE_PX, LEAST_PIECES, MOST_PIECES = 24.0, 4, 20
USUAL_PX = 6.0


def mask_under(image: GreyImage, on_cable_px: Points) -> CableMask | None:
    """Return the mask that holds most of the given points; None where no cable is seen.

    Args:
        image: Grey image.
        on_cable_px: Points on the cable, shape (N, 2); they tell bright cables on dark tables
            from dark ones on bright tables.
    """
    places = pixels_of(on_cable_px, image.shape)
    masks = [mask for mask in (find_mask(image), find_mask(255 - image)) if mask is not None]
    return max(
        masks,
        key=lambda mask: (float(mask.cable[places].mean()), mask.contrast),
        default=None,
    )


def cable_width(image: GreyImage, start_px: Points) -> float | None:
    """Return the width of the cable that starts at some points; None where no cable is seen.

    The mask knows the cable's width from all of its length, unless it took something else for
    cable; the profile at the start is of this cable, unless others lie beside it. Each is wrong
    where the other is not, so their geometric mean is nearer than either.

    Args:
        image: Grey image.
        start_px: First points of the cable, in order, shape (N, 2), N >= 1.
    """
    return width_with(mask_under(image, start_px), image, start_px)


def width_with(mask: CableMask | None, image: GreyImage, start_px: Points) -> float | None:
    """Return the same as `cable_width`, given the mask that holds the start."""
    across = width_across(image, start_px) if len(start_px) > 1 else None
    if mask is None:
        return across
    return mask.width_px if across is None else float(np.sqrt(across * mask.width_px))


def width_under(image: GreyImage, lines_px: Sequence[Points]) -> float:
    """Return the width of cables along given lines, from many short pieces of them.

    Where too few profiles show a cable, the mask tells, and where there is none, cables are taken
    to be `USUAL_PX` wide.

    Args:
        image: Grey image.
        lines_px: Centre lines, shape (N, 2) each.
    """
    length_px = sum(float(arc_lengths(line)[-1]) for line in lines_px)
    every_px = max(PIECE_PX, length_px / MOST_PIECES)
    pieces = [piece for line in lines_px for piece in _pieces(line, every_px)]
    widths = [found for piece in pieces if (found := width_across(image, piece)) is not None]
    if len(widths) >= LEAST_PIECES:
        return float(np.median(widths))
    mask = mask_under(image, np.vstack(lines_px))
    return mask.width_px if mask is not None else USUAL_PX


def _pieces(line: Points, every_px: float) -> list[Points]:
    arcs = arc_lengths(line)
    starts = np.arange(0.0, arcs[-1] - PIECE_PX, every_px)
    return [point_at(line, arcs, start + np.linspace(0.0, PIECE_PX, 7)) for start in starts]


def width_across(image: GreyImage, line_px: Points) -> float | None:
    """Return the cable's width from its profile across a piece of its centre line.

    Args:
        image: Grey image.
        line_px: Points along the piece, shape (N, 2), N >= 2.

    Returns:
        From border to border [px]; None where the profile shows no cable.
    """
    profiles = _profiles(image, line_px)
    offsets = np.linspace(-REACH_PX, REACH_PX, profiles.shape[1])
    far, near = np.abs(offsets) > TABLE_PX, np.abs(offsets) <= ASIDE_PX
    profile = np.median(profiles, axis=0) - float(np.median(profiles[:, far]))
    noise = float(np.median(np.abs(profile[far])))
    middle = float(np.median(profile[near]))
    if abs(middle) < max(CLEAR * noise, LEAST):
        return None
    low = np.sign(middle) * profile < BORDER * abs(middle)
    left, right = (offsets[low & side] for side in (offsets < 0.0, offsets > 0.0))
    return float(right.min() - left.max()) if len(left) and len(right) else None


def _profiles(image: GreyImage, line_px: Points) -> Points:
    """Return grey values across a line, smoothed along it, one row a pixel of it."""
    arcs = arc_lengths(line_px)
    points = point_at(line_px, arcs, np.arange(0.0, arcs[-1] + 0.5))
    along = tangents(points, 4)
    across = np.column_stack([-along[:, 1], along[:, 0]])
    offsets = np.linspace(-REACH_PX, REACH_PX, int(2 * REACH_PX / FINE_PX) + 1)
    places = (points[:, None] + offsets[None, :, None] * across[:, None]).astype(np.float32)
    values = cv2.remap(
        image, places[..., 0], places[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
    )
    return np.asarray(values, dtype=float)
