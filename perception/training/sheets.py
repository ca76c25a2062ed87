"""Contact sheets: many small images on one, so that a person can judge them."""

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from perception.training.drawn import DrawnScene

Bytes = NDArray[np.uint8]

COLUMNS, TILE_PX, MARGIN_PX = 5, 300, 4
# One colour a cable.
COLOURS = ((255, 80, 60), (70, 190, 255), (110, 230, 90))


def draw_truth_over(image: Bytes, scene: DrawnScene) -> Bytes:
    """Return an image in colour with centre lines, crossings and ends, shape (H, W, 3)."""
    drawn = np.repeat(image[:, :, None], 3, axis=2)
    thickness = max(round(0.2 * scene.width_px), 1)
    for number, cable in enumerate(scene.cables):
        line = np.round(np.array(cable.points_px) * 8.0).astype(np.int32)[:, None]
        colour = COLOURS[number % len(COLOURS)]
        cv2.polylines(drawn, [line], False, colour, thickness, cv2.LINE_AA, 3)
    radius = max(round(scene.width_px), 3)
    for crossing in scene.crossings:
        x, y = (round(value) for value in crossing.position_px)
        cv2.circle(drawn, (x, y), radius, (255, 255, 0), 1, cv2.LINE_AA)
    for end in scene.ends:
        x, y = (round(value) for value in end.position_px)
        shape = cv2.MARKER_SQUARE if end.connector else cv2.MARKER_DIAMOND
        colour = (0, 255, 120) if end.visible else (150, 150, 150)
        cv2.drawMarker(drawn, (x, y), colour, shape, 2 * radius, 2)
    return drawn


def contact_sheet(tiles: Sequence[Bytes]) -> Bytes:
    """Return images of any size side by side, grey ones or in colour; shape (H, W, 3)."""
    small = [_fitted(tile) for tile in tiles]
    rows = -(-len(small) // COLUMNS)
    down = max(tile.shape[0] for tile in small) + MARGIN_PX
    right = max(tile.shape[1] for tile in small) + MARGIN_PX
    sheet = np.full((rows * down, min(len(small), COLUMNS) * right, 3), 128, np.uint8)
    for number, tile in enumerate(small):
        y, x = down * (number // COLUMNS), right * (number % COLUMNS)
        height, width = tile.shape[:2]
        sheet[y : y + height, x : x + width] = tile if tile.ndim == 3 else tile[:, :, None]
    return sheet


def _fitted(tile: Bytes) -> Bytes:
    """Return an image of the size of a tile."""
    scale = TILE_PX / max(tile.shape[:2])
    how = cv2.INTER_AREA if scale < 1.0 else cv2.INTER_NEAREST
    return np.asarray(cv2.resize(tile, None, fx=scale, fy=scale, interpolation=how), np.uint8)
