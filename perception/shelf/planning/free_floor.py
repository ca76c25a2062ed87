"""The part of a shelf's floor that a view shows to be free."""

import numpy as np

from perception.shelf.casting import BoxCaster
from perception.shelf.types import Bools, Floats, Shelf, ShelfView

CELL_M = 0.01
# What is looked at just above the floor is free when depth there is not smaller by more.
MARGIN_M = 0.008
ABOVE_M = 0.012
# A footprint is free when this share of its cells is; edges fall on cells by chance.
ENOUGH = 0.95


class FreeFloor:
    """Which cells of the floor are seen to be free."""

    def __init__(self, view: ShelfView, shelf: Shelf, caster: BoxCaster, own: Floats) -> None:
        """Look at every cell once.

        Args:
            view: What is seen.
            shelf: The shelf.
            caster: Rays of the view's camera.
            own: Footprint of an object that is going to leave its place, shape (4,).
        """
        free = free_cells(view, shelf, caster) | covered_cells(own, shelf)
        self._sums = np.zeros((free.shape[0] + 1, free.shape[1] + 1))
        self._sums[1:, 1:] = free.cumsum(axis=0).cumsum(axis=1)

    def holds(self, places: Floats) -> Bools:
        """Say which footprints, shape (K, 4), lie on free floor."""
        last = np.array(self._sums.shape) - 1
        low = np.clip(np.rint(places[:, :2] / CELL_M).astype(int), 0, last)
        high = np.clip(np.rint(places[:, 2:] / CELL_M).astype(int), low, last)
        sums = self._sums
        free = sums[high[:, 0], high[:, 1]] - sums[low[:, 0], high[:, 1]]
        free = free - sums[high[:, 0], low[:, 1]] + sums[low[:, 0], low[:, 1]]
        cells = (high - low).prod(axis=1)
        return np.asarray((free >= ENOUGH * cells) & (cells > 0))


def free_cells(view: ShelfView, shelf: Shelf, caster: BoxCaster) -> Bools:
    """Say which cells of the floor a view shows to be free, shape (nx, ny)."""
    grid_x, grid_y = _grid(shelf)
    points_m = np.stack([grid_x, grid_y, np.full_like(grid_x, ABOVE_M)], axis=-1)
    return _seen_free(points_m.reshape(-1, 3), view, caster).reshape(grid_x.shape)


def covered_cells(own: Floats, shelf: Shelf) -> Bools:
    """Say which cells of the floor lie in a footprint, shape (4,)."""
    grid_x, grid_y = _grid(shelf)
    inside = (grid_x > own[0]) & (grid_x < own[2]) & (grid_y > own[1]) & (grid_y < own[3])
    return np.asarray(inside)


def _grid(shelf: Shelf) -> tuple[Floats, Floats]:
    x_m = np.arange(0.5 * CELL_M, shelf.width_m, CELL_M)
    y_m = np.arange(0.5 * CELL_M, shelf.depth_m, CELL_M)
    grid_x, grid_y = np.meshgrid(x_m, y_m, indexing="ij")
    return grid_x, grid_y


def _seen_free(points_m: Floats, view: ShelfView, caster: BoxCaster) -> Bools:
    camera = view.camera
    pixels = np.rint(camera.project(points_m)).astype(int)
    inside = (pixels >= 0).all(axis=1)
    inside &= (pixels[:, 0] < camera.width_px) & (pixels[:, 1] < camera.height_px)
    along = camera.T_world_camera[:3, 2]
    own_m = (points_m - caster.origin_m) @ along
    depth_m = np.full(len(points_m), np.nan)
    depth_m[inside] = view.depth_m[pixels[inside, 1], pixels[inside, 0]]
    # Where depth is unknown nothing is known to be free: a comparison with NaN is false.
    return np.asarray(depth_m > own_m - MARGIN_M)
