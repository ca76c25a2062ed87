"""Packages as they look: colours and labels, a new edition of every product whenever one is drawn.

A label names the product and its brand, among other print. Colours follow a product's habit
loosely, as on real shelves: what is sold as mint is often green, and not always.
"""

import colorsys
import zlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from perception.shelf.types import Size
from simulation.shelf.taxonomy import ShelfObject

Texture = NDArray[np.uint8]
Colour = tuple[int, int, int]

TEXELS_PER_M = 4000
# How far an edition's hue may be from the habit of its product, as a share of all hues.
HUE_SPREAD = 0.10
# Of a label's height.
BRAND_SHARE, NAME_SHARE, PRINT_SHARE = 0.16, 0.42, 0.07
MARGIN_SHARE = 0.07
SMALL_PRINT = (
    "60 tablets", "200 ml", "new formula", "dermatologically tested", "net wt 8 oz", "family size",
    "keep out of reach of children", "made with care", "30 capsules", "500 g", "best before end",
    "store in a cool place", "shake well", "recyclable", "extra strong", "pack of 12",
)  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class Package:
    """One edition of a product.

    Attributes:
        base: Colour all round, red, green and blue.
        front: Its label, shape (height, width, 3).
        name_height_m: Height of the letters of its name on the label.
    """

    base: Colour
    front: Texture
    name_height_m: float


def draw_package(thing: ShelfObject, size_m: Size, rng: np.random.Generator) -> Package:
    """Draw an edition of a product.

    Args:
        thing: The product.
        size_m: Width, depth and height of the package.
        rng: Source of chance.
    """
    base, band = _colours(thing.name, rng)
    width, height = (max(24, round(TEXELS_PER_M * side_m)) for side_m in (size_m[0], size_m[2]))
    sheet = Image.new("RGB", (width, height), base)
    pen = ImageDraw.Draw(sheet)
    _ornament(pen, sheet.size, band, rng)
    brand_first = bool(rng.random() < 0.7)
    top = MARGIN_SHARE * height
    brand_box = (width, BRAND_SHARE * height)
    name_box = (width, NAME_SHARE * height)
    letters = 0.0
    for is_brand in (brand_first, not brand_first):
        box = brand_box if is_brand else name_box
        ground = band if is_brand else base
        if is_brand:
            pen.rectangle((0, top, width, top + box[1]), fill=ground)
        text = _cased(thing.brand if is_brand else thing.name, rng)
        size = _write(pen, text, (0.0, top), box, _ink(ground, rng), rng)
        letters = letters if is_brand else size
        top += box[1] + 0.04 * height
    for _ in range(int(rng.integers(0, 3))):
        line = str(rng.choice(SMALL_PRINT))
        _write(pen, line, (0.0, top), (width, PRINT_SHARE * height), _ink(base, rng), rng)
        top += 1.2 * PRINT_SHARE * height
    return Package(base, np.asarray(sheet, dtype=np.uint8), letters / TEXELS_PER_M)


def habit_hue(name: str) -> float:
    """Return the hue that editions of a product tend to, in [0, 1)."""
    return (zlib.crc32(name.encode()) % 997) / 997.0


def _colours(name: str, rng: np.random.Generator) -> tuple[Colour, Colour]:
    """Return the colour all round, and that of the brand's band."""
    hue = habit_hue(name) + HUE_SPREAD * rng.normal()
    pale = rng.random() < 0.45
    base = (hue, rng.uniform(0.0, 0.25), rng.uniform(0.8, 0.97))
    strong = (hue, rng.uniform(0.5, 0.95), rng.uniform(0.35, 0.85))
    other = (hue + rng.uniform(-0.15, 0.15), rng.uniform(0.4, 0.9), rng.uniform(0.3, 0.9))
    return (_rgb(base), _rgb(strong)) if pale else (_rgb(strong), _rgb(other))


def _rgb(hsv: tuple[float, float, float]) -> Colour:
    red, green, blue = colorsys.hsv_to_rgb(hsv[0] % 1.0, hsv[1], hsv[2])
    return (round(255 * red), round(255 * green), round(255 * blue))


def _ink(ground: Colour, rng: np.random.Generator) -> Colour:
    """Return a colour that can be read on a ground."""
    bright = 0.3 * ground[0] + 0.59 * ground[1] + 0.11 * ground[2]
    grey = int(rng.integers(0, 60) if bright > 128 else rng.integers(200, 256))
    return (grey, grey, grey)


def _ornament(
    pen: ImageDraw.ImageDraw, size: tuple[int, int], colour: Colour, rng: np.random.Generator
) -> None:
    """Put a stripe or a disc where there is no writing."""
    width, height = size
    if rng.random() < 0.5:
        top = height * rng.uniform(0.8, 0.92)
        pen.rectangle((0, top, width, height), fill=colour)
    else:
        radius = 0.12 * min(width, height)
        x, y = rng.uniform(0.2, 0.8) * width, 0.87 * height
        pen.ellipse((x - radius, y - radius, x + radius, y + radius), fill=colour)


def _cased(text: str, rng: np.random.Generator) -> str:
    return (text, text.upper(), text.title())[int(rng.integers(3))]


def _write(
    pen: ImageDraw.ImageDraw,
    text: str,
    corner: tuple[float, float],
    box: tuple[float, float],
    ink: Colour,
    rng: np.random.Generator,
) -> float:
    """Write a text as large as its box allows, in one line or in words; return its height."""
    wide = (1.0 - 2.0 * MARGIN_SHARE) * box[0]
    layouts = [[text], text.split()] if " " in text else [[text]]
    size, lines = max(((_fitting(lines, wide, box[1]), lines) for lines in layouts),
                      key=lambda pair: pair[0])  # fmt: skip
    font = ImageFont.load_default(max(size, 1.0))
    shift = rng.uniform(0.0, 0.5)
    for number, line in enumerate(lines):
        free = wide - font.getlength(line)
        x = corner[0] + MARGIN_SHARE * box[0] + shift * max(free, 0.0)
        pen.text((x, corner[1] + 1.15 * size * number), line, fill=ink, font=font)
    # Capitals take about seven tenths of a font's size.
    return 0.7 * size


def _fitting(lines: Sequence[str], wide: float, high: float) -> float:
    """Return the largest size of letters with which all lines fit."""
    unit = ImageFont.load_default(100.0)
    longest = max(unit.getlength(line) for line in lines)
    return min(100.0 * wide / longest, high / (1.2 * len(lines)))
