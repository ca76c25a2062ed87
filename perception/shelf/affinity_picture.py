"""Affinity matrices as heat maps, in the manner of the thesis's Fig. 6.3."""

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from perception.shelf.affinity import AffinityMatrix
from perception.shelf.types import Floats

CELL_PX = 20
MARGIN_PX = 8
FONT_PX = 13
# From none to all of a row, between dark blue and yellow.
SHADES = np.array(
    [[18, 24, 62], [44, 74, 138], [44, 138, 142], [120, 196, 110], [250, 230, 90]], np.float64
)


def affinity_picture(matrix: AffinityMatrix) -> NDArray[np.uint8]:
    """Draw a matrix with its names: rows are asked for, columns stand beside them.

    Brightness goes with the square root of a share, so that weak affinities can be told apart.

    Args:
        matrix: What to draw.

    Returns:
        RGB image, shape (height, width, 3).
    """
    font = ImageFont.load_default(FONT_PX)
    label_px = MARGIN_PX + max(int(font.getlength(name)) for name in matrix.names)
    side_px = CELL_PX * len(matrix.names)
    title = f"{matrix.origin.model}: affinity of the row's object to the column's"
    top_px = label_px + MARGIN_PX + FONT_PX + MARGIN_PX
    width_px = max(label_px + MARGIN_PX + side_px, int(font.getlength(title))) + 2 * MARGIN_PX
    sheet = Image.new("RGB", (width_px, top_px + side_px + MARGIN_PX), "white")
    pen = ImageDraw.Draw(sheet)
    pen.text((MARGIN_PX, MARGIN_PX), title, "black", font)
    left_px = label_px + MARGIN_PX
    sheet.paste(_cells(matrix.rows), (left_px, top_px))
    for row, name in enumerate(matrix.names):
        y_px = top_px + CELL_PX * row + 2
        pen.text((left_px - 4 - font.getlength(name), y_px), name, "black", font)
        upright = _upright(name, label_px, font)
        sheet.paste(upright, (left_px + CELL_PX * row + 2, top_px - label_px - 2))
    return np.asarray(sheet, dtype=np.uint8)


def _cells(rows: Floats) -> Image.Image:
    shades = np.sqrt(rows / max(float(rows.max()), 1e-12)) * (len(SHADES) - 1)
    low = np.minimum(shades.astype(int), len(SHADES) - 2)
    part = (shades - low)[..., None]
    colours = (1.0 - part) * SHADES[low] + part * SHADES[low + 1]
    large = np.repeat(np.repeat(colours, CELL_PX, axis=0), CELL_PX, axis=1)
    return Image.fromarray(large.round().astype(np.uint8))


def _upright(
    name: str, length_px: int, font: ImageFont.FreeTypeFont | ImageFont.ImageFont
) -> Image.Image:
    strip = Image.new("RGB", (length_px, CELL_PX - 2), "white")
    ImageDraw.Draw(strip).text((0, 0), name, "black", font)
    return strip.rotate(90, expand=True)
