"""From a view to boxes: where objects stand, as far as depth and their known sizes tell."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import find_objects

from perception.shelf.casting import BoxCaster
from perception.shelf.completing import completed
from perception.shelf.types import Bools, Box, Floats, Shelf, ShelfView, Sighting, Size

# Thinnest that an object of unknown size is taken to be (thesis, section 5.2: S_min).
THINNEST_M = 0.05
# Of an object's points this share may lie before its front or beside its sides, by noise.
OUTLIERS = 0.02
# Two pixels that differ by more in depth do not show the same surface.
STEP_M = 0.01
# What is nearest of an object and is narrower or lower may be a side or a top, and not its front.
SLIVER_M = 0.012
# What shows higher than it is by more does not stand on the floor.
ON_ANOTHER_M = 0.02


def sightings(
    view: ShelfView, shelf: Shelf, sizes_m: Mapping[str, Size], caster: BoxCaster
) -> tuple[Sighting, ...]:
    """Find the boxes of all objects in a view.

    Args:
        view: What is seen.
        shelf: What it stands in.
        sizes_m: Sizes of the objects that are known; others are as large as what is seen of them.
        caster: Rays of the view's camera.

    Returns:
        One sighting for each label of which depth is known somewhere.
    """
    depth_m = view.depth_m.astype(np.float64)
    points_m = caster.origin_m + depth_m[..., None] * caster.rays
    found = []
    for index, window in enumerate(_windows(view)):
        label = view.labels[index]
        if window is None:
            continue
        known = (view.segments[window] == index) & np.isfinite(depth_m[window])
        if known.any():
            size_m = sizes_m.get(label)
            box, sure = _boxes(points_m[window], depth_m[window], known, size_m, shelf, caster)
            found.append(Sighting(label, view.segments == index, box, sure))
    return completed(found, view, shelf, caster)


def _windows(view: ShelfView) -> list[tuple[slice, slice] | None]:
    """Return the part of the image that holds each object, and a pixel around it."""
    windows: list[tuple[slice, slice] | None] = [None] * len(view.labels)
    for index, found in enumerate(find_objects(view.segments + 1, len(view.labels))):
        if found is not None:
            rows, columns = (slice(max(0, one.start - 1), one.stop + 1) for one in found)
            windows[index] = rows, columns
    return windows


@dataclass(frozen=True, slots=True)
class _Extent:
    """What is seen of an object: from where to where, and whether that is its front."""

    left_m: float
    right_m: float
    front_m: float
    back_m: float
    top_m: float
    is_front: bool


def _boxes(
    points_m: Floats,
    depth_m: Floats,
    mask: Bools,
    size_m: Size | None,
    shelf: Shelf,
    caster: BoxCaster,
) -> tuple[Box, Box]:
    """Return the completed box and its sure part."""
    near, extent = _extent(points_m, mask, caster)
    width_m = max(extent.right_m - extent.left_m, 1e-3)
    middle_m = 0.5 * (extent.left_m + extent.right_m)
    if size_m is None:
        size_m = (width_m, max(THINNEST_M, extent.back_m - extent.front_m), extent.top_m)
    half_m = 0.5 * np.array(size_m[:2])
    y_m = extent.front_m + half_m[1] if extent.is_front else extent.back_m - half_m[1]
    y_m = float(np.clip(y_m, half_m[1], shelf.depth_m - half_m[1]))
    sure = Box(middle_m, y_m, (min(width_m, size_m[0]), size_m[1], size_m[2]))
    if not extent.is_front:
        deep_m = extent.back_m - extent.front_m
        seen_y_m = 0.5 * (extent.front_m + extent.back_m)
        sure = Box(middle_m, seen_y_m, (min(width_m, size_m[0]), deep_m, extent.top_m))
    x_m = _centre(extent.left_m, extent.right_m, size_m[0], _open_sides(depth_m, near))
    x_m = float(np.clip(x_m, half_m[0], shelf.width_m - half_m[0]))
    bottom_m = _bottom_m(extent.top_m, size_m[2])
    return Box(x_m, y_m, size_m, bottom_m), replace(sure, bottom_m=bottom_m)


def _bottom_m(top_m: float, height_m: float) -> float:
    """Return at which height an object stands: what shows higher than it is stands on another."""
    above_m = top_m - height_m
    return above_m if above_m > ON_ANOTHER_M else 0.0


def _extent(points_m: Floats, mask: Bools, caster: BoxCaster) -> tuple[Bools, _Extent]:
    """Measure an object; also returns the pixels of what is nearest of it."""
    seen = points_m[mask]
    front_m, back_m = np.quantile(seen[:, 1], [OUTLIERS, 1.0 - OUTLIERS]).tolist()
    top_m = float(np.quantile(seen[:, 2], 1.0 - OUTLIERS))
    near = mask & (points_m[..., 1] < front_m + STEP_M)
    front = points_m[near]
    half_px_m = 0.5 * (front_m - float(caster.origin_m[1])) / caster.camera.focal_px
    left_m, right_m = front[:, 0].min() - half_px_m, front[:, 0].max() + half_px_m
    tall_m = front[:, 2].max() - front[:, 2].min()
    is_front = min(right_m - left_m, tall_m) > SLIVER_M
    return near, _Extent(float(left_m), float(right_m), front_m, back_m, top_m, bool(is_front))


def _centre(left_m: float, right_m: float, width_m: float, open_sides: tuple[bool, bool]) -> float:
    """Complete a front of known width from the side of it that nothing hides."""
    if open_sides == (True, False):
        return left_m + 0.5 * width_m
    if open_sides == (False, True):
        return right_m - 0.5 * width_m
    return 0.5 * (left_m + right_m)


def _open_sides(depth_m: Floats, near: Bools) -> tuple[bool, bool]:
    """Say whether left and right of a front something farther away is seen, in most rows."""
    sides = []
    for step in (-1, 1):
        beside = np.roll(near, step, axis=1) & ~near
        own_m = np.roll(np.where(near, depth_m, np.nan), step, axis=1)[beside]
        nearer = depth_m[beside] < own_m - STEP_M
        sides.append(bool(nearer.mean() < 0.5) if len(nearer) else False)
    return sides[0], sides[1]
