"""What cables end in: plugs, USB plugs, jacks, adapters wider than a palm, or nothing."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Picture = NDArray[np.float32]
Kind = Literal["plug", "usb", "jack", "adapter"]

BARE = 0.18
# Whatever its cable, a connector may be black or white.
OTHER_GREY = 0.4
# Fractions of a pixel that outlines are drawn to.
SHIFT = 3


@dataclass(frozen=True, slots=True, eq=False)
class Connector:
    """A plug or an adapter at one end of a cable.

    Attributes:
        kind: `plug`, `usb`, `jack` or `adapter`.
        cable: Number of the cable.
        end: 0 where the cable's line begins, 1 where it ends.
        covered: Whether strands lie over it, not under it.
        outlines_px: Corners of its parts, shape (4, 2) each; the first begins where the cable
            ends.
        greys: Grey value of each part.
    """

    kind: Kind
    cable: int
    end: int
    covered: bool
    outlines_px: tuple[Floats, ...]
    greys: tuple[float, ...]

    def hides(self, point_px: Floats) -> bool:
        """Say whether nothing below it can be seen at a point."""
        place = (float(point_px[0]), float(point_px[1]))
        corners = (outline.astype(np.float32)[:, None] for outline in self.outlines_px)
        return not self.covered and any(
            cv2.pointPolygonTest(outline, place, False) >= 0.0 for outline in corners
        )


@dataclass(frozen=True, slots=True, eq=False)
class _Place:
    tip_px: Floats
    out: Floats
    width_px: float

    def quad(self, begin: float, end: float, near: float, far: float) -> Floats:
        """Return corners; lengths in cable widths, `near` and `far` are widths there."""
        side = 0.5 * self.width_px * np.array([-self.out[1], self.out[0]])
        first, last = (self.tip_px + at * self.width_px * self.out for at in (begin, end))
        return np.array(
            [first - near * side, first + near * side, last + far * side, last - far * side]
        )


_Parts = list[tuple[Floats, float]]


def draw_up_connectors(
    rng: np.random.Generator, cable: int, line_px: Floats, width_px: float, brightness: float
) -> list[Connector]:
    """Return the connectors of one cable; few of its ends are bare.

    Args:
        rng: Source of all randomness.
        cable: Number of the cable.
        line_px: Its centre line, half a cable width a node, shape (N, 2) or more columns.
        width_px: Its width.
        brightness: Its grey value; connectors often have one near it.
    """
    made = []
    for end, (tip, inner) in enumerate(((line_px[0], line_px[2]), (line_px[-1], line_px[-3]))):
        if rng.random() < BARE:
            continue
        out = tip[:2] - inner[:2]
        out /= max(float(np.linalg.norm(out)), 1e-9)
        kind = [*_KINDS][rng.choice(len(_KINDS), p=[0.46, 0.18, 0.12, 0.24])]
        parts = _KINDS[kind](rng, _Place(tip[:2], out, width_px), _grey(rng, brightness))
        outlines, greys = zip(*parts, strict=True)
        made.append(Connector(kind, cable, end, bool(rng.random() < 0.5), outlines, greys))
    return made


def draw_connectors(picture: Picture, connectors: Sequence[Connector], scale: float) -> None:
    """Draw connectors into a picture that is `scale` times as fine, in place."""
    for connector in connectors:
        for outline, grey in zip(connector.outlines_px, connector.greys, strict=True):
            places = np.round((outline * scale + 0.5 * (scale - 1.0)) * 2**SHIFT)
            cv2.fillPoly(picture, [places.astype(np.int32)[:, None]], grey, cv2.LINE_8, SHIFT)


def _grey(rng: np.random.Generator, brightness: float) -> float:
    if rng.random() < OTHER_GREY:
        return float(rng.uniform(5.0, 250.0))
    return _near(rng, brightness, 45.0)


def _near(rng: np.random.Generator, grey: float, spread: float) -> float:
    return float(np.clip(grey + rng.normal(0.0, spread), 0.0, 255.0))


def _plug(rng: np.random.Generator, place: _Place, grey: float) -> _Parts:
    parts, at = [], 0.0
    for _ in range(int(rng.integers(1, 4))):
        wide, length = rng.uniform(1.0, 2.6), rng.uniform(0.8, 2.5)
        quad = place.quad(at, at + length, wide, wide * rng.uniform(0.6, 1.0))
        parts.append((quad, _near(rng, grey, 45.0)))
        at += length
    return parts


def _usb(rng: np.random.Generator, place: _Place, grey: float) -> _Parts:
    wide, long, shell = rng.uniform(1.6, 3.2), rng.uniform(2.0, 5.0), rng.uniform(1.2, 3.0)
    metal, narrow = rng.uniform(120.0, 250.0), wide * rng.uniform(0.6, 0.9)
    parts = [
        (place.quad(0.0, 0.8, 1.2, 0.7 * wide), _near(rng, grey, 15.0)),
        (place.quad(0.8, long, wide, wide), grey),
        (place.quad(long, long + shell, narrow, narrow), metal),
    ]
    for side in (-0.22, 0.22):
        hole = place.quad(long + 0.35 * shell, long + 0.65 * shell, 0.18 * narrow, 0.18 * narrow)
        shift = side * narrow * place.width_px * np.array([-place.out[1], place.out[0]])
        parts.append((hole + shift, 0.35 * metal))
    return parts


def _jack(rng: np.random.Generator, place: _Place, grey: float) -> _Parts:
    wide, long, pin = rng.uniform(1.3, 2.2), rng.uniform(1.5, 4.0), rng.uniform(1.0, 2.5)
    thin = rng.uniform(0.35, 0.7)
    return [
        (place.quad(0.0, long, wide, wide * rng.uniform(0.7, 1.0)), grey),
        (place.quad(long, long + pin, thin, 0.8 * thin), rng.uniform(90.0, 250.0)),
    ]


def _adapter(rng: np.random.Generator, place: _Place, grey: float) -> _Parts:
    wide, long = rng.uniform(1.8, 6.0), rng.uniform(2.0, 7.5)
    rim, label = rng.uniform(0.05, 0.25) * wide, rng.uniform(0.2, 0.6) * wide
    parts = [
        (place.quad(0.0, long, wide, wide * rng.uniform(0.7, 1.0)), _near(rng, grey, 25.0)),
        (place.quad(0.5 * rim, long - 0.5 * rim, 0.7 * wide - rim, 0.7 * wide - rim), grey),
    ]
    if rng.random() < 0.4:
        middle = rng.uniform(0.35, 0.65) * long
        quad = place.quad(middle - 0.2 * long, middle + 0.2 * long, label, label)
        parts.append((quad, _near(rng, grey, 60.0)))
    return parts


_KINDS: dict[Kind, Callable[[np.random.Generator, _Place, float], _Parts]] = {
    "plug": _plug,
    "usb": _usb,
    "jack": _jack,
    "adapter": _adapter,
}
