"""Connectors at the ends of cables, and things on the table that only look like them."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Picture = NDArray[np.float32]

BARE = 0.15
ADAPTER = 0.25
# Whatever its cable, a connector may be black or white.
OTHER_GREY = 0.35
# Fractions of a pixel that outlines are drawn to.
SHIFT = 3


@dataclass(frozen=True, slots=True, eq=False)
class Connector:
    """A plug or an adapter at one end of a cable.

    Attributes:
        cable: Number of the cable.
        end: 0 where the cable's line begins, 1 where it ends.
        covered: Whether strands lie over it, not under it.
        outlines_px: Corners of its parts, shape (4, 2) each; the first begins where the cable
            ends.
        greys: Grey value of each part.
    """

    cable: int
    end: int
    covered: bool
    outlines_px: tuple[Floats, ...]
    greys: tuple[float, ...]


def draw_up_connectors(
    rng: np.random.Generator, cable: int, line_px: Floats, width_px: float, brightness: float
) -> list[Connector]:
    """Return the connectors of one cable; few of its ends are bare.

    Args:
        rng: Source of all randomness.
        cable: Number of the cable.
        line_px: Its centre line, half a cable width a node, shape (N, 2) or more columns.
        width_px: Its width.
        brightness: Its grey value.
    """
    made = []
    for end, (tip, inner) in enumerate(((line_px[0], line_px[2]), (line_px[-1], line_px[-3]))):
        if rng.random() < BARE:
            continue
        out = tip[:2] - inner[:2]
        out /= max(float(np.linalg.norm(out)), 1e-9)
        outlines = _outlines(rng, tip[:2], out, width_px)
        greys = tuple(_grey(rng, brightness) for _ in outlines)
        made.append(Connector(cable, end, bool(rng.random() < 0.5), outlines, greys))
    return made


def _outlines(
    rng: np.random.Generator, at: Floats, out: Floats, width_px: float
) -> tuple[Floats, ...]:
    side = np.array([-out[1], out[0]])
    adapter = rng.random() < ADAPTER
    outlines = []
    for _ in range(int(rng.integers(1, 4))):
        half = side * width_px * (rng.uniform(0.9, 2.4) if adapter else rng.uniform(0.5, 1.3))
        length = out * width_px * rng.uniform(0.8, 2.5)
        narrow = half * rng.uniform(0.6, 1.0)
        outlines.append(
            np.array([at - half, at + half, at + length + narrow, at + length - narrow])
        )
        at = at + length
    return tuple(outlines)


def _grey(rng: np.random.Generator, brightness: float) -> float:
    if rng.random() < OTHER_GREY:
        return float(rng.uniform(5.0, 250.0))
    return float(np.clip(brightness + rng.normal(0.0, 45.0), 0.0, 255.0))


def draw_connector(picture: Picture, connector: Connector, scale: float = 1.0) -> None:
    """Draw a connector into a picture that is `scale` times as fine, in place."""
    for outline, grey in zip(connector.outlines_px, connector.greys, strict=True):
        _fill(picture, outline * scale + 0.5 * (scale - 1.0), grey)


def draw_distractors(
    rng: np.random.Generator, picture: Picture, width_px: float, brightness: float
) -> None:
    """Draw what is neither cable nor connector: rods, scissors, screws, paper, in place.

    Rods are narrower or wider than cable, so that straight cable stays cable.
    """
    rows, columns = picture.shape
    for _ in range(int(rng.integers(1, 5))):
        at = rng.uniform(0.0, 1.0, 2) * (columns, rows)
        grey = _grey(rng, brightness)
        kind = rng.choice(["rod", "scissors", "disc", "ring", "sheet"])
        if kind == "rod":
            _draw_rod(rng, picture, at, width_px, grey)
        elif kind == "scissors":
            for _ in range(2):
                _draw_rod(rng, picture, at, width_px, grey)
        elif kind == "sheet":
            corners = at + rng.uniform(-1.0, 1.0, (4, 2)) * rng.uniform(2.0, 8.0) * width_px
            _fill(picture, corners, grey)
        else:
            thickness = -1 if kind == "disc" else max(int(rng.uniform(0.15, 0.5) * width_px), 1)
            radius = max(int(rng.uniform(0.4, 2.2) * width_px), 1)
            centre = (int(at[0]), int(at[1]))
            cv2.circle(picture, centre, radius, grey, thickness, cv2.LINE_AA)


def _draw_rod(
    rng: np.random.Generator, picture: Picture, at: Floats, width_px: float, grey: float
) -> None:
    turn = rng.uniform(0.0, 2.0 * np.pi)
    along = np.array([np.cos(turn), np.sin(turn)])
    side = np.array([-along[1], along[0]])
    thin = rng.random() < 0.5
    half = side * 0.5 * width_px * (rng.uniform(0.15, 0.6) if thin else rng.uniform(1.7, 4.0))
    tapered = half * rng.uniform(0.2, 1.0)
    length = along * width_px * rng.uniform(3.0, 16.0)
    _fill(
        picture,
        np.array([at - half, at + half, at + length + tapered, at + length - tapered]),
        grey,
    )


def _fill(picture: Picture, corners: Floats, grey: float) -> None:
    """Fill a polygon; corners in pixels of the picture."""
    places = np.round(corners * 2**SHIFT).astype(np.int32)
    cv2.fillPoly(picture, [places[:, None]], grey, cv2.LINE_AA, SHIFT)
