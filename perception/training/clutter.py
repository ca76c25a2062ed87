"""Things on the table that are no cables: screws, rods, tape, paper, print, scissors, blobs."""

from collections.abc import Callable

import cv2
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Canvas = NDArray[np.uint8]
_SHIFT = 3


def draw_clutter(
    rng: np.random.Generator, canvas: Canvas, width_px: float, count: int, cable: float
) -> None:
    """Draw a number of things somewhere, in place, smooth-edged.

    Args:
        rng: Source of all randomness.
        canvas: Grey values.
        width_px: Width of the cables.
        count: How many things.
        cable: Grey value of the cables, on which large things would hide them.
    """
    kinds = rng.choice(len(_THINGS), size=count, p=_SHARES)
    for kind in kinds:
        at = rng.uniform(0.0, 1.0, 2) * canvas.shape[::-1]
        _THINGS[kind](rng, canvas, width_px, at, _grey(rng, cable))


def fill(canvas: Canvas, corners: Floats, grey: float) -> None:
    """Fill a convex polygon, smooth-edged, in place."""
    fixed = np.round(corners * (1 << _SHIFT)).astype(np.int32)
    cv2.fillConvexPoly(canvas, fixed, grey, cv2.LINE_AA, _SHIFT)


def box(middle: Floats, along: Floats, length: float, across: float) -> Floats:
    """Return the corners of a rectangle; `along` is a unit vector."""
    side = np.array([-along[1], along[0]]) * across / 2.0
    half = along * length / 2.0
    return middle + np.array([-half - side, half - side, half + side, -half + side])


def heading(rng: np.random.Generator) -> Floats:
    """Return a random unit vector."""
    turn = rng.uniform(0.0, 2.0 * np.pi)
    return np.array([np.cos(turn), np.sin(turn)])


def _grey(rng: np.random.Generator, cable: float) -> float:
    """Return a grey value away from that of the cables."""
    apart = rng.uniform(28.0, 200.0) * rng.choice([-1.0, 1.0])
    mirrored = cable + apart if 0.0 <= cable + apart <= 255.0 else cable - apart
    return float(np.clip(mirrored, 0.0, 255.0))


def _disc(canvas: Canvas, at: Floats, radius: float, grey: float, thickness: int = -1) -> None:
    scale = 1 << _SHIFT
    middle = (round(at[0] * scale), round(at[1] * scale))
    cv2.circle(canvas, middle, round(radius * scale), grey, thickness, cv2.LINE_AA, _SHIFT)


def _line(canvas: Canvas, points: Floats, grey: float, thickness: float) -> None:
    fixed = np.round(points * (1 << _SHIFT)).astype(np.int32)
    wide = max(round(thickness), 1)
    cv2.polylines(canvas, [fixed[:, None]], False, grey, wide, cv2.LINE_AA, _SHIFT)


def _blobs(
    rng: np.random.Generator, canvas: Canvas, width_px: float, at: Floats, grey: float
) -> None:
    for place in at + rng.normal(0.0, 3.0 * width_px, (int(rng.integers(1, 7)), 2)):
        _disc(canvas, place, rng.uniform(0.15, 0.9) * width_px, grey)
    if rng.random() < 0.3:
        ring = max(round(rng.uniform(0.15, 0.5) * width_px), 1)
        _disc(canvas, at, rng.uniform(0.8, 2.5) * width_px, grey, ring)


def _screw(
    rng: np.random.Generator, canvas: Canvas, width_px: float, at: Floats, grey: float
) -> None:
    radius, along = rng.uniform(0.4, 1.6) * width_px, heading(rng)
    if rng.random() < 0.5:
        shaft = box(at + along * 2.0 * radius, along, 3.5 * radius, 0.8 * radius)
        fill(canvas, shaft, float(np.clip(grey + rng.normal(0.0, 25.0), 0.0, 255.0)))
    _disc(canvas, at, radius, grey)
    slot = np.array([at - 0.7 * radius * along, at + 0.7 * radius * along])
    _line(canvas, slot, (grey + 110.0) % 255.0, 0.3 * radius)


def _rod(
    rng: np.random.Generator, canvas: Canvas, width_px: float, at: Floats, grey: float
) -> None:
    # Clearly thinner or thicker than cables: else nobody could tell it from a straight one.
    across = rng.choice([rng.uniform(0.15, 0.5), rng.uniform(1.7, 3.0)]) * width_px
    along, length = heading(rng), rng.uniform(3.0, 14.0) * width_px
    fill(canvas, box(at, along, length, across), grey)
    lighter = float(np.clip(grey + rng.uniform(-40.0, 60.0), 0.0, 255.0))
    fill(canvas, box(at, along, length, 0.4 * across), lighter)


def _tape(
    rng: np.random.Generator, canvas: Canvas, width_px: float, at: Floats, grey: float
) -> None:
    length, across = rng.uniform(4.0, 16.0) * width_px, rng.uniform(1.8, 5.0) * width_px
    patch = np.zeros(canvas.shape, np.uint8)
    fill(patch, box(at, heading(rng), length, across), 255.0)
    share = rng.uniform(0.15, 0.9)
    mixed = canvas[patch > 127] * (1.0 - share) + grey * share
    canvas[patch > 127] = mixed.astype(np.uint8)


def _paper(
    rng: np.random.Generator, canvas: Canvas, width_px: float, at: Floats, grey: float
) -> None:
    along = heading(rng)
    length, across = rng.uniform(8.0, 26.0, 2) * width_px
    sheet = box(at, along, length, across)
    fill(canvas, sheet + rng.uniform(-0.3, 0.3, 2) * width_px, 0.6 * grey)
    fill(canvas, sheet, grey)
    if rng.random() < 0.5:
        _text(rng, canvas, width_px, at, (grey + 128.0) % 255.0)


def _text(
    rng: np.random.Generator, canvas: Canvas, width_px: float, at: Floats, grey: float
) -> None:
    letters = np.array(list("ABEHKLMNRSTXZ0134578agekmrs+-/#"))
    scale = rng.uniform(0.02, 0.09) * width_px
    font = int(rng.choice([cv2.FONT_HERSHEY_SIMPLEX, cv2.FONT_HERSHEY_COMPLEX]))
    for row in range(int(rng.integers(1, 5))):
        word = "".join(rng.choice(letters, int(rng.integers(2, 12))))
        place = (int(at[0]), int(at[1] + 35.0 * scale * row))
        cv2.putText(canvas, word, place, font, scale, grey, max(round(1.5 * scale), 1), cv2.LINE_AA)


def _scissors(
    rng: np.random.Generator, canvas: Canvas, width_px: float, at: Floats, grey: float
) -> None:
    """Draw two rings with two blades, at the pivot."""
    along = heading(rng)
    opening, size = rng.uniform(0.1, 0.45), rng.uniform(3.0, 9.0) * width_px
    steel = float(np.clip(grey + rng.uniform(-80.0, 80.0), 0.0, 255.0))
    for sign in (-1.0, 1.0):
        c, s = np.cos(sign * opening), np.sin(sign * opening)
        leg = np.array([c * along[0] - s * along[1], s * along[0] + c * along[1]])
        side = 0.09 * size * np.array([-leg[1], leg[0]])
        fill(canvas, np.array([at - side, at + side, at + size * leg]), steel)
        ring = at - 0.75 * size * leg
        _line(canvas, np.array([at, ring]), steel, 0.1 * size)
        _disc(canvas, ring, 0.26 * size, grey, max(round(0.09 * size), 1))


def _strip(
    rng: np.random.Generator, canvas: Canvas, width_px: float, at: Floats, grey: float
) -> None:
    """Draw a power strip: a bar with sockets in it."""
    along = heading(rng)
    sockets, across = int(rng.integers(2, 6)), rng.uniform(3.0, 5.5) * width_px
    fill(canvas, box(at, along, (sockets + 0.5) * across, across), grey)
    for k in range(sockets):
        place = at + along * (k - 0.5 * (sockets - 1)) * across
        _disc(canvas, place, 0.36 * across, float((grey + rng.uniform(30.0, 70.0)) % 255.0))
        for hole in (-0.14, 0.14):
            _disc(canvas, place + hole * across * along, 0.06 * across, 20.0)


_SHARES = (0.24, 0.14, 0.13, 0.13, 0.13, 0.09, 0.08, 0.06)
_THINGS: tuple[Callable[[np.random.Generator, Canvas, float, Floats, float], None], ...] = (
    _blobs,
    _screw,
    _rod,
    _tape,
    _paper,
    _text,
    _scissors,
    _strip,
)
