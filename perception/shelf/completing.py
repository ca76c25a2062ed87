"""Where the rest of an object may be of which only a part is seen.

Its size is known. So it stands somewhere in a range, and nowhere where more of it would show than
does, nor where something else stands. The middle of what is left is the best guess, and half its
width says how good a guess that is.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from perception.shelf.casting import BoxCaster
from perception.shelf.planning.room import footprints, overlapping
from perception.shelf.types import Bools, Box, Floats, Shelf, ShelfView, Sighting

# Distance of the places that are tried, and from when on a range is worth it.
STEP_M = 0.004
LEAST_M = 0.008
# A place would show where depth is larger than its own by more.
MARGIN_M = 0.012
# That many pixels, or that share of them, may do so by chance.
STRAY, STRAY_SHARE = 2.0, 0.015
# Boxes are taken to be smaller by this on each side when they are held against each other.
TOUCH_M = 0.004


@dataclass(frozen=True, slots=True, eq=False)
class _Range:
    """Places of one object that are tried: centres, shape (K, 2)."""

    number: int
    centres_m: Floats


def completed(
    found: Sequence[Sighting], view: ShelfView, shelf: Shelf, caster: BoxCaster
) -> tuple[Sighting, ...]:
    """Return sightings with boxes in the middle of where they may be.

    Args:
        found: All sightings of one view, their boxes completed from what is seen of each alone.
        view: What is seen.
        shelf: What it stands in.
        caster: Rays of the view's camera.
    """
    ranges = [
        _Range(number, places)
        for number, sighting in enumerate(found)
        if len(places := _places(sighting, shelf)) > 1
    ]
    if not ranges:
        return tuple(found)
    fits = _fits([(found[each.number], each.centres_m) for each in ranges], view, caster)
    sure, better = footprints([sighting.sure for sighting in found]), list(found)
    for one, mine in zip(ranges, fits, strict=True):
        others = sure[beside([sighting.sure for sighting in found], one.number)]
        own = mine & clear_of(found[one.number].box, one.centres_m, others)
        if own.any():
            better[one.number] = _middle(found[one.number], one.centres_m[own])
    return tuple(better)


def _places(sighting: Sighting, shelf: Shelf) -> Floats:
    """Return where the centre of an object may be by its size and what is seen of it."""
    spans = []
    room_m = (shelf.width_m, shelf.depth_m)
    centre_m, seen_m = (sighting.box.x_m, sighting.box.y_m), (sighting.sure.x_m, sighting.sure.y_m)
    for axis in (0, 1):
        size_m = sighting.box.size_m[axis]
        loose_m = 0.5 * (size_m - sighting.sure.size_m[axis])
        low_m, high_m = seen_m[axis] - loose_m, seen_m[axis] + loose_m
        low_m, high_m = max(low_m, 0.5 * size_m), min(high_m, room_m[axis] - 0.5 * size_m)
        if high_m - low_m < LEAST_M:
            spans.append(np.array([centre_m[axis]]))
        else:
            spans.append(np.linspace(low_m, high_m, 1 + round((high_m - low_m) / STEP_M)))
    return np.stack(np.meshgrid(*spans, indexing="ij"), axis=-1).reshape(-1, 2)


def _fits(
    tried: Sequence[tuple[Sighting, Floats]], view: ShelfView, caster: BoxCaster
) -> list[Bools]:
    """Say at which places hardly any pixel speaks against each object."""
    counts = [len(places) for _, places in tried]
    centres_m = np.vstack([places for _, places in tried])
    sizes_m = np.repeat([sighting.box.size_m for sighting, _ in tried], counts, axis=0)
    bottoms_m = np.repeat([sighting.box.bottom_m for sighting, _ in tried], counts)
    low_m = np.column_stack([centres_m - 0.5 * sizes_m[:, :2], bottoms_m])
    shown = caster.cast(low_m, low_m + sizes_m)
    # Where depth is unknown nothing speaks against it: a comparison with NaN is false.
    through = view.depth_m.ravel()[shown.pixel] > shown.depth_m + MARGIN_M
    stray = shown.sums(through.astype(np.float64))
    limit = np.maximum(STRAY, STRAY_SHARE * shown.sums(np.ones(len(shown.pixel))))
    return np.split(stray <= limit, np.cumsum(counts)[:-1])


def beside(boxes: Sequence[Box], number: int) -> Bools:
    """Say which boxes share a height with one of them, so that they stand beside it, shape (N,)."""
    own = boxes[number]
    level = [
        min(own.high_m[2], one.high_m[2]) - max(own.low_m[2], one.low_m[2]) > TOUCH_M
        for one in boxes
    ]
    level[number] = False
    return np.array(level, dtype=bool)


def clear_of(box: Box, centres_m: Floats, others: Floats) -> Bools:
    """Say at which places, shape (K, 2), an object stands on no other footprint, shape (N, 4)."""
    half_m = 0.5 * np.array(box.size_m[:2]) - TOUCH_M
    places = np.hstack([centres_m - half_m, centres_m + half_m])
    return np.asarray(~overlapping(places[:, None], others[None]).any(axis=1))


def _middle(sighting: Sighting, centres_m: Floats) -> Sighting:
    """Return an object in that of its places that is nearest to their middle."""
    low_m, high_m = centres_m.min(axis=0), centres_m.max(axis=0)
    nearest = centres_m[np.abs(centres_m - 0.5 * (low_m + high_m)).sum(axis=1).argmin()]
    x_m, y_m = nearest.tolist()
    loose_x_m, loose_y_m = (0.5 * (high_m - low_m)).tolist()
    box = sighting.box.at(x_m, y_m)
    return replace(sighting, box=box, loose_m=(loose_x_m, loose_y_m))
