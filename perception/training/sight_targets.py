"""What the detector should answer, as maps."""

import cv2
import numpy as np
from numpy.typing import NDArray

from perception.models.sight_input import STRIDE
from perception.training.sight_scenes import WIDEST_TANGLE, SightTruth

Floats = NDArray[np.float64]
Maps = NDArray[np.float32]

# Maps of targets on the grid. Heats come first, as in `sight_net.HEATS`, then their weights.
HEATS, WEIGHTS = slice(0, 3), slice(3, 6)
AT_END, OFFSET, DIRECTION, PLUGGED = 6, slice(7, 9), slice(9, 11), 11
AT_TANGLE, LOG_RADIUS, AT_CABLE, LOG_WIDTH, CONNECTOR = 12, 13, 14, 15, 16
MAPS = 17
# An end hidden or this near to the border [cable widths] is neither wanted nor unwanted.
INSIDE, AROUND = 0.6, 2.0
# Cells this near to an end answer for it.
ANSWERS_CELLS = 1.5


def grid_of(truth: SightTruth) -> Maps:
    """Return targets on the grid, shape (MAPS, H / 4, W / 4)."""
    rows, columns = (side // STRIDE for side in truth.image.shape)
    grid = np.zeros((MAPS, rows, columns), np.float32)
    grid[WEIGHTS] = 1.0
    spread = max(0.8, 0.12 * truth.width_px)
    _add_ends(grid, truth, spread)
    for place in truth.crossings:
        _add_heat(grid[1], _cells(place), spread)
    _add_tangles(grid, truth)
    for place, mask in ((AT_CABLE, truth.cable), (CONNECTOR, truth.connector)):
        share = cv2.resize(mask.astype(np.float32), (columns, rows), interpolation=cv2.INTER_AREA)
        grid[place] = share > 0.5
    half = STRIDE // 2
    grid[LOG_WIDTH] = np.log(truth.widths_px[half::STRIDE, half::STRIDE])
    return grid


def _cells(place_px: Floats) -> Floats:
    """Return a place in cells, the middle of the first one at 0."""
    return (place_px + 0.5) / STRIDE - 0.5


def _gaps(grid: Maps, at: Floats) -> Maps:
    y, x = np.ogrid[: grid.shape[-2], : grid.shape[-1]]
    gaps: Maps = np.hypot(x - at[0], y - at[1]).astype(np.float32)
    return gaps


def _add_heat(heat: Maps, at: Floats, spread: float) -> None:
    """Add a bump with its top, 1, in the cell that holds a place."""
    column, row = (round(float(value)) for value in at)
    bump = np.exp(-0.5 * (_gaps(heat, at) / spread) ** 2)
    np.maximum(heat, np.minimum(bump, 0.98), out=heat)
    if 0 <= row < heat.shape[0] and 0 <= column < heat.shape[1]:
        heat[row, column] = 1.0


def _add_ends(grid: Maps, truth: SightTruth, spread: float) -> None:
    last = np.array(truth.image.shape[::-1]) - 1
    reach = AROUND * truth.width_px
    order = np.argsort(truth.visible, kind="stable")
    for k in order:
        place = truth.ends[k]
        depth = float(np.minimum(place, last - place).min())
        if depth < -reach:
            continue
        at = _cells(place)
        gaps = _gaps(grid, at)
        if not truth.visible[k] or depth < INSIDE * truth.width_px:
            grid[WEIGHTS.start][gaps * STRIDE < reach] = 0.0
            continue
        _add_heat(grid[0], at, spread)
        grid[WEIGHTS.start][grid[0] == 1.0] = 1.0
        rows, columns = np.nonzero(gaps < ANSWERS_CELLS)
        grid[AT_END, rows, columns] = 1.0
        grid[OFFSET, rows, columns] = (at[:, None] - np.stack([columns, rows])).astype(np.float32)
        grid[DIRECTION, rows, columns] = truth.inwards[k][:, None]
        grid[PLUGGED, rows, columns] = truth.plugged[k]


def _add_tangles(grid: Maps, truth: SightTruth) -> None:
    last = np.array(truth.image.shape[::-1]) - 1
    for x, y, radius in truth.tangles:
        at = _cells(np.array([x, y]))
        gaps = _gaps(grid, at)
        inside = float(min(x, y, last[0] - x, last[1] - y)) > 0.5 * radius
        if radius > WIDEST_TANGLE * truth.width_px or not inside:
            grid[WEIGHTS.start + 2][gaps * STRIDE < radius] = 0.0
            continue
        spread = max(1.5, radius / STRIDE / 4.0)
        _add_heat(grid[2], at, spread)
        rows, columns = np.nonzero(gaps < spread)
        grid[AT_TANGLE, rows, columns] = 1.0
        grid[LOG_RADIUS, rows, columns] = np.log(radius)
