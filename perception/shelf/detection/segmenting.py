"""Objects on a shelf apart from each other by depth alone, whatever they are.

Objects are cuboids with their faces along the shelf (thesis, section 5.2), so that a front has one
distance from the shelf's edge. Fronts are told apart where that distance jumps or where the height
of their upper edge does; tops and sides go to the front that is nearest in the image.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, label

from perception.rgbd import RgbdFrame
from perception.shelf.casting import BoxCaster
from perception.shelf.types import NOTHING, Bools, Floats, Segments, Shelf

Ints = NDArray[np.int64]

# A jump between neighbouring pixels that is no noise any more.
STEP_M = 0.004
# The same between columns of a patch, whose noise is that of many pixels: height and distance.
PROFILE_STEP_M = np.array([0.003, 0.002])
# Nearer than this is a side wall, the floor, the back. Floor and sides are seen at grazing angles,
# where errors of depth move points along them.
SIDE_M, FLOOR_M, BACK_M = 0.002, 0.0008, 0.006
# Farther before the shelf is no part of it.
FRONT_M = 0.02
# Smallest object, as a share of the image's width squared; smaller patches are noise or slivers.
LEAST_SHARE = 7e-5
# Width of the rim of a patch that its own jumps have taken.
RIM_PX = 2
# What is thinner than so many pixels in images of this width, or than three, is no object.
TAIL_PX, TAIL_WIDTH_PX = 5, 1280
# So far around an upper edge its height is looked at, as a share of the image's width.
EDGE_SHARE = 0.004


@dataclass(frozen=True, slots=True, eq=False)
class ShelfPoints:
    """Where the pixels of a frame lie.

    Attributes:
        points_m: Points in the shelf's frame, shape (height, width, 3); lost depth is filled in
            from its neighbours.
        things: Which pixels show something before the walls.
    """

    points_m: Floats
    things: Bools


def shelf_points(frame: RgbdFrame, shelf: Shelf) -> ShelfPoints:
    """Measure the pixels of a frame."""
    caster = BoxCaster(frame.camera)
    filled = cv2.medianBlur(np.nan_to_num(frame.depth_m, nan=0.0).astype(np.float32), 5)
    points_m = caster.origin_m + filled.astype(np.float64)[..., None] * caster.rays
    low_m = np.array([SIDE_M, -FRONT_M, FLOOR_M])
    high_m = np.array([shelf.width_m - SIDE_M, shelf.depth_m - BACK_M, shelf.height_m - SIDE_M])
    inside = ((points_m > low_m) & (points_m < high_m)).all(axis=2)
    return ShelfPoints(points_m, np.asarray(inside & (filled > 0.0)))


def segmented(points: ShelfPoints) -> Segments:
    """Tell objects apart.

    Args:
        points: Where the pixels lie.

    Returns:
        Which object each pixel shows, by number, or `NOTHING`; shape (height, width).
    """
    least_px = round(LEAST_SHARE * points.things.shape[1] ** 2)
    # Specks would stretch the object that is nearest to them.
    things = _large(label(points.things)[0], least_px) > 0
    points = ShelfPoints(points.points_m, things)
    numbers, _ = label(things & ~_jumps(points.points_m[..., 1]))
    numbers = _split_by_profile(_large(numbers, least_px), points)
    numbers = _joined_behind(_large(numbers, least_px), points)
    return _grown(numbers, points)


def _jumps(y_m: Floats) -> Bools:
    """Say where the distance from the shelf's edge changes by more than noise does."""
    jumps = np.zeros(y_m.shape, dtype=bool)
    across = np.abs(np.diff(y_m, axis=1)) > STEP_M
    down = np.abs(np.diff(y_m, axis=0)) > STEP_M
    jumps[:, 1:] |= across
    jumps[1:, :] |= down
    return jumps


def _large(numbers: Segments, least_px: int) -> Segments:
    """Return the patches that are large enough, numbered from 1."""
    sizes = np.bincount(numbers.ravel())
    kept = sizes >= least_px
    kept[0] = False
    renumbered = np.where(kept, np.cumsum(kept), 0)
    return np.asarray(renumbered[numbers], dtype=np.int16)


def _split_by_profile(numbers: Segments, points: ShelfPoints) -> Segments:
    """Cut patches where the height of their upper edge jumps, or their mean distance does."""
    split, last = numbers.copy(), int(numbers.max())
    reach_px = max(2, round(EDGE_SHARE * numbers.shape[1]))
    for number in range(1, int(numbers.max()) + 1):
        patch = numbers == number
        columns = np.flatnonzero(patch.any(axis=0))
        starts = _steps(_profile(patch, columns, points), reach_px)
        for start, end in zip(starts, [*starts[1:], len(columns)], strict=True):
            last += 1
            part = np.zeros_like(patch)
            part[:, columns[start:end]] = patch[:, columns[start:end]]
            split[part] = last
    return split


def _profile(patch: Bools, columns: Ints, points: ShelfPoints) -> Floats:
    """Return the height of the upper edge and the mean distance, column by column, shape (C, 2)."""
    shown = patch[:, columns]
    tops_m = points.points_m[shown.argmax(axis=0), columns, 2]
    y_m = np.where(shown, points.points_m[:, columns, 1], 0.0)
    return np.column_stack([tops_m, y_m.sum(axis=0) / shown.sum(axis=0)])


def _steps(profile_m: Floats, reach_px: int) -> list[int]:
    """Return where the pieces of a profile begin that have one value each."""
    starts = [0]
    for at in range(reach_px, len(profile_m) - reach_px + 1):
        before, behind = profile_m[at - reach_px : at], profile_m[at : at + reach_px]
        step_m = np.abs(np.median(before, axis=0) - np.median(behind, axis=0))
        calm = np.maximum(np.ptp(before, axis=0), np.ptp(behind, axis=0)) < 0.5 * step_m
        if at - starts[-1] >= reach_px and bool((calm & (step_m > PROFILE_STEP_M)).any()):
            starts.append(at)
    return starts


@dataclass(frozen=True, slots=True)
class _Front:
    """A front: how deep in the shelf, how high, and from where to where in the image."""

    y_m: float
    top_m: float
    first: int
    last: int


def _joined_behind(numbers: Segments, points: ShelfPoints) -> Segments:
    """Give the pieces of an object that another hides in its middle one number."""
    count = int(numbers.max())
    fronts = [_front(numbers == number, points) for number in range(1, count + 1)]
    joined = np.arange(count + 1)
    order = sorted(range(count), key=lambda index: fronts[index].first)
    for at, left in enumerate(order):
        for right in order[at + 1 :]:
            if _one_behind(fronts[left], fronts[right], numbers, points):
                joined[right + 1] = joined[left + 1]
                break
    return _large(np.asarray(joined[numbers], dtype=np.int16), 1)


def _front(patch: Bools, points: ShelfPoints) -> _Front:
    columns = np.flatnonzero(patch.any(axis=0))
    seen_m = points.points_m[patch]
    return _Front(
        float(np.quantile(seen_m[:, 1], 0.1)), float(np.quantile(seen_m[:, 2], 0.99)),
        int(columns[0]), int(columns[-1]),
    )  # fmt: skip


def _one_behind(left: _Front, right: _Front, numbers: Segments, points: ShelfPoints) -> bool:
    """Say whether two fronts are one with something nearer between them."""
    alike = max(abs(left.y_m - right.y_m), abs(left.top_m - right.top_m)) < 0.5 * STEP_M
    if not alike or right.first <= left.last + 1:
        return False
    between = points.points_m[:, left.last + 1 : right.first]
    level = np.abs(between[..., 2] - left.top_m) < 0.1 * max(left.top_m, 0.05)
    shown = numbers[:, left.last + 1 : right.first] > 0
    nearer = level & shown & (between[..., 1] < left.y_m - STEP_M)
    return bool(nearer.any(axis=0).mean() > 0.9)


def _grown(numbers: Segments, points: ShelfPoints) -> Segments:
    """Give every pixel of a thing to the patch beside it at its distance, or else the nearest."""
    if not numbers.any():
        return np.full(numbers.shape, NOTHING, dtype=np.int16)
    # NOTHING is -1, one less than the first number.
    grown, y_m = numbers.copy(), points.points_m[..., 1]
    for _ in range(RIM_PX):
        for axis in (0, 1):
            for step in (-1, 1):
                beside = np.roll(grown, step, axis)
                level = np.abs(np.roll(y_m, step, axis) - y_m) < STEP_M
                taken = (grown == 0) & level & points.things
                grown[taken] = beside[taken]
    rows, columns = distance_transform_edt(grown == 0, return_distances=False, return_indices=True)
    whole = np.where(points.things, grown[rows, columns], 0).astype(np.int16)
    return _large(np.where(_without_tails(whole), whole, 0).astype(np.int16), 1) - np.int16(1)


def _without_tails(numbers: Segments) -> Bools:
    """Say which pixels are no thin tail of their patch, as mixed depth at edges makes them."""
    kept = np.zeros(numbers.shape, dtype=bool)
    side_px = max(3, round(TAIL_PX * numbers.shape[1] / TAIL_WIDTH_PX) // 2 * 2 + 1)
    brush = np.ones((side_px, side_px), np.uint8)
    for number in range(1, int(numbers.max()) + 1):
        patch = (numbers == number).astype(np.uint8)
        kept |= cv2.morphologyEx(patch, cv2.MORPH_OPEN, brush) > 0
    return kept
