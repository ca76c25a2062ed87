"""Cables with known centre lines and crossings, and a small renderer that shares no code."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.ndimage import gaussian_filter, gaussian_filter1d

Floats = NDArray[np.float64]
SHAPE = (773, 1032)
WIDTH_PX = 7.0


@dataclass(frozen=True, slots=True, eq=False)
class Drawing:
    """Centre line in pixels with heights in cable widths, shape (N, 3)."""

    nodes: Floats

    @property
    def points_px(self) -> Floats:
        return self.nodes[:, :2]


def evenly(nodes: Floats, step: float = 3.0) -> Floats:
    """Return the nodes at nearly equal steps in the plane."""
    arcs = np.r_[0.0, np.linalg.norm(np.diff(nodes[:, :2], axis=0), axis=1).cumsum()]
    at = np.linspace(0.0, arcs[-1], int(arcs[-1] / step))
    return np.stack([np.interp(at, arcs, nodes[:, axis]) for axis in range(nodes.shape[1])], 1)


def _with_tails(loop: Floats, centre: tuple[float, float], radius_px: float) -> Drawing:
    """Open a closed curve at its outermost point and lead both ends away."""
    body = loop[6:-6].copy()
    body[:, :2] = body[:, :2] / 3.0 * radius_px + centre
    tails = []
    for end, inner, rise in ((body[0], body[8], 2.0), (body[-1], body[-9], -2.0)):
        way = (end - inner)[:2] / np.linalg.norm((end - inner)[:2])
        out = np.array([1.0, 0.0])
        steps = np.linspace(0.0, 1.0, 30)[1:, None]
        tail = end[:2] + steps * 140.0 * way + steps**2 * 220.0 * out
        tails.append(np.c_[tail, end[2] + rise * np.minimum(4.0 * steps, 1.0)])
    nodes = evenly(np.vstack([tails[0][::-1], body, tails[1]]))
    return Drawing(gaussian_filter1d(nodes, 6.0, axis=0, mode="nearest")[3:-3])


def overhand(centre: tuple[float, float] = (400.0, 380.0), radius_px: float = 120.0) -> Drawing:
    t = np.linspace(0.0, 2.0 * np.pi, 400)
    ring = 2.0 + np.cos(3.0 * t)
    loop = np.c_[ring * np.cos(2.0 * t), ring * np.sin(2.0 * t), 1.5 * np.sin(3.0 * t)]
    return _with_tails(loop, centre, radius_px)


def figure_8(centre: tuple[float, float] = (400.0, 380.0), radius_px: float = 150.0) -> Drawing:
    t = np.linspace(0.0, 2.0 * np.pi, 500)
    ring = 2.0 + np.cos(2.0 * t)
    loop = np.c_[ring * np.cos(3.0 * t), ring * np.sin(3.0 * t), 1.5 * np.sin(4.0 * t)]
    return _with_tails(loop, centre, radius_px)


def laid_down(drawing: Drawing) -> Drawing:
    """Return the same curve in the plane, laid down from one end to the other: no knot."""
    heights = np.linspace(0.0, 12.0, len(drawing.nodes))
    return Drawing(np.c_[drawing.points_px, heights])


def wander(rng: np.random.Generator, corners: int = 9) -> Drawing:
    """Return a random smooth curve whose height follows its own random course."""
    while True:
        way = rng.uniform((140.0, 120.0), (890.0, 600.0), (corners, 2))
        if np.linalg.norm(np.diff(way, axis=0), axis=1).min() < 180.0:
            continue
        knots = np.r_[0.0, np.sqrt(np.linalg.norm(np.diff(way, axis=0), axis=1)).cumsum()]
        fine = np.linspace(0.0, knots[-1], 1500)
        plane = CubicSpline(knots, way)(fine)
        height = CubicSpline(np.linspace(0, knots[-1], 14), rng.uniform(0.0, 6.0, 14))(fine)
        drawing = Drawing(evenly(np.c_[plane, height]))
        if _is_fair(drawing):
            return drawing


def _is_fair(drawing: Drawing) -> bool:
    """Keep cables that a cable could be: in view, no sharp bends, no glancing crossings."""
    points = drawing.points_px
    if (points < 40.0).any() or (points > (SHAPE[1] - 40.0, SHAPE[0] - 40.0)).any():
        return False
    steps = np.diff(points[::6], axis=0)
    headings = np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))
    if np.abs(np.diff(headings)).max() > 18.0 / 25.0:
        return False
    coarse = points[::4]
    gaps = np.linalg.norm(coarse[:, None] - coarse[None], axis=2)
    far = np.abs(np.subtract.outer(np.arange(len(gaps)), np.arange(len(gaps)))) > 6
    close = (gaps < 16.0) & far
    # Near places are crossings, each a short diagonal; long runs side by side are left out.
    ends_clear = not close[:6].any() and not close[-6:].any()
    return bool(ends_clear and 30 < close.sum() < 130 and close.sum(axis=1).max() <= 5)


def render(
    drawing: Drawing,
    rng: np.random.Generator,
    *,
    width_px: float = WIDTH_PX,
    cloth: float = 60.0,
    cable: float = 190.0,
    noise: float = 5.0,
    blur_px: float = 0.7,
    shadow: float = 0.1,
    connectors: bool = True,
) -> NDArray[np.uint8]:
    """Paint the cable piece by piece from the lowest to the highest, with contact shadows."""
    y, x = np.mgrid[: SHAPE[0], : SHAPE[1]]
    image = cloth * (1.0 + 0.15 * np.sin(x / 260.0 + rng.uniform(0, 6)) * np.cos(y / 210.0))
    pieces = np.c_[drawing.nodes[:-1], drawing.nodes[1:]]
    for piece in pieces[np.argsort(pieces[:, 2] + pieces[:, 5])]:
        _paint(image, piece[:2], piece[3:5], width_px / 2.0, cable, shadow)
    if connectors:
        for end, inner in ((0, 4), (-1, -5)):
            way = drawing.points_px[end] - drawing.points_px[inner]
            way = way / np.linalg.norm(way)
            start = drawing.points_px[end]
            _paint(image, start, start + 16.0 * way, width_px * 0.95, cable + 25.0, 0.0)
    image = gaussian_filter(image, blur_px) + rng.normal(0.0, noise, SHAPE)
    return np.clip(np.rint(image), 0, 255).astype(np.uint8)


def _paint(
    image: Floats, a: Floats, b: Floats, radius_px: float, grey: float, shadow: float
) -> None:
    reach = radius_px * 2.0 + 2.0
    low = np.floor(np.minimum(a, b) - reach).astype(int)
    high = np.ceil(np.maximum(a, b) + reach).astype(int) + 1
    low, high = np.maximum(low, 0), np.minimum(high, SHAPE[::-1])
    if (low >= high).any():
        return
    y, x = np.mgrid[low[1] : high[1], low[0] : high[0]]
    along = b - a
    share = ((x - a[0]) * along[0] + (y - a[1]) * along[1]) / max(float(along @ along), 1e-9)
    share = np.clip(share, 0.0, 1.0)
    distance = np.hypot(x - a[0] - share * along[0], y - a[1] - share * along[1])
    window = image[low[1] : high[1], low[0] : high[0]]
    # Only beside the strand: what lies under it is painted over, what lies ahead is itself.
    dark = shadow * np.clip(1.8 - distance / radius_px, 0.0, 0.8)
    window *= np.where(distance > radius_px, 1.0 - dark, 1.0)
    body = grey * (0.62 + 0.38 * np.sqrt(np.clip(1.0 - (distance / radius_px) ** 2, 0.0, 1.0)))
    cover = np.clip(radius_px + 0.5 - distance, 0.0, 1.0)
    window += cover * (body - window)
