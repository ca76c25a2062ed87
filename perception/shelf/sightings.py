"""From a view to boxes: where the seen objects stand, as far as depth and their known sizes tell."""

from collections.abc import Mapping

import numpy as np

from perception.shelf.casting import BoxCaster
from perception.shelf.types import Bools, Box, Floats, Shelf, ShelfView, Sighting, Size

# Thinnest that an object of unknown size is taken to be (thesis, section 5.2: S_min).
THINNEST_M = 0.05
# Of an object's points this share may lie before its front or beside its sides, by noise.
OUTLIERS = 0.02
# Two pixels that differ by more in depth do not show the same surface.
STEP_M = 0.01


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
    for index, label in enumerate(view.labels):
        mask = view.segments == index
        known = mask & np.isfinite(depth_m)
        if known.any():
            box, sure = _boxes(points_m, depth_m, known, sizes_m.get(label), shelf, caster)
            found.append(Sighting(label, mask, box, sure))
    return tuple(found)


def _boxes(
    points_m: Floats, depth_m: Floats, mask: Bools, size_m: Size | None, shelf: Shelf,
    caster: BoxCaster,
) -> tuple[Box, Box]:  # fmt: skip
    """Return the completed box and its sure part."""
    seen = points_m[mask]
    front_m = float(np.quantile(seen[:, 1], OUTLIERS))
    near = mask & (points_m[..., 1] < front_m + STEP_M)
    left_m, right_m = _sides(points_m, near, caster)
    top_m = float(np.quantile(seen[:, 2], 1.0 - OUTLIERS))
    if size_m is None:
        deep_m = max(THINNEST_M, float(np.quantile(seen[:, 1], 1.0 - OUTLIERS)) - front_m)
        size_m = (right_m - left_m, deep_m, top_m)
    back_m = min(front_m + size_m[1], shelf.depth_m)
    front_m = back_m - size_m[1]
    width_m = max(right_m - left_m, 1e-3)
    y_m = 0.5 * (front_m + back_m)
    sure = Box(0.5 * (left_m + right_m), y_m, (min(width_m, size_m[0]), size_m[1], size_m[2]))
    x_m = _centre(left_m, right_m, size_m[0], _open_sides(depth_m, near))
    half_m = 0.5 * size_m[0]
    return Box(float(np.clip(x_m, half_m, shelf.width_m - half_m)), y_m, size_m), sure


def _sides(points_m: Floats, near: Bools, caster: BoxCaster) -> tuple[float, float]:
    """Return where the front that is seen begins and ends; a pixel's centre is inside it."""
    x_m = points_m[near][:, 0]
    half_px_m = 0.5 * float(np.median(points_m[near][:, 1] - caster.origin_m[1]))
    half_px_m /= caster.camera.focal_px
    return float(x_m.min()) - half_px_m, float(x_m.max()) + half_px_m


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
