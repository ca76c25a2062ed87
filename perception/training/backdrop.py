"""What lies under and beside the cables: cloth, folds, clutter, robot parts."""

import cv2
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Picture = NDArray[np.float32]


def draw_table(
    rng: np.random.Generator, size_px: tuple[int, int], level: float, width_px: float
) -> Picture:
    """Return a table of grey value `level` with uneven light, weave and clutter."""
    rows = size_px[0]
    picture = np.full(size_px, level, np.float32)
    picture += _clouds(rng, size_px, int(rng.integers(2, 6))) * rng.uniform(0.0, 18.0)
    if rng.random() < 0.5:
        picture += _clouds(rng, size_px, max(rows // 12, 2)) * rng.uniform(0.0, 6.0)
    if rng.random() < 0.5:
        picture += _weave(rng, size_px) * rng.uniform(1.0, 9.0)
    for _ in range(int(rng.integers(0, 4))):
        _draw_fold(rng, picture, width_px)
    if rng.random() < 0.4:
        _draw_edge(rng, picture)
    if rng.random() < 0.35:
        for _ in range(int(rng.integers(1, 4))):
            _draw_part(rng, picture, width_px)
    return np.clip(picture, 0.0, 255.0)


def _clouds(rng: np.random.Generator, size_px: tuple[int, int], cells: int) -> Picture:
    coarse = rng.standard_normal((cells, cells)).astype(np.float32)
    clouds = cv2.resize(coarse, size_px[::-1], interpolation=cv2.INTER_CUBIC)
    return clouds.astype(np.float32)


def _weave(rng: np.random.Generator, size_px: tuple[int, int]) -> Picture:
    turn, period = rng.uniform(0.0, np.pi), rng.uniform(2.2, 9.0)
    y, x = np.mgrid[: size_px[0], : size_px[1]].astype(np.float32)
    u = (np.cos(turn) * x + np.sin(turn) * y) * (2.0 * np.pi / period)
    if rng.random() < 0.5:
        stripes: Picture = np.sin(u)
        return stripes
    v = (-np.sin(turn) * x + np.cos(turn) * y) * (2.0 * np.pi / period)
    woven: Picture = np.sin(u) * np.sin(v)
    return woven


def _draw_fold(rng: np.random.Generator, picture: Picture, width_px: float) -> None:
    """Draw a soft line that is no cable: a fold, a seam, a scratch."""
    rows, columns = picture.shape
    ends = rng.uniform(0.0, 1.0, (2, 2)) * (columns, rows)
    points = np.linspace(ends[0], ends[1], 12) + rng.normal(0.0, 0.02 * rows, (12, 2))
    layer = np.zeros(picture.shape, np.float32)
    thickness = max(int(rng.uniform(0.2, 2.5) * width_px), 1)
    cv2.polylines(layer, [np.round(points).astype(np.int32)[:, None]], False, 1.0, thickness)
    soft = cv2.GaussianBlur(layer, (0, 0), rng.uniform(0.3, 1.0) * width_px).astype(np.float32)
    picture += soft * rng.uniform(-1.0, 1.0) * 22.0


def _draw_edge(rng: np.random.Generator, picture: Picture) -> None:
    """Draw the border of a cloth: one half of the picture gets another level."""
    rows, columns = picture.shape
    turn = rng.uniform(0.0, 2.0 * np.pi)
    y, x = np.mgrid[:rows, :columns].astype(np.float32)
    away = np.cos(turn) * (x / columns - 0.5) + np.sin(turn) * (y / rows - 0.5)
    beyond = away > rng.uniform(0.25, 0.5)
    picture[beyond] += np.float32(rng.uniform(-60.0, 60.0))


def _draw_part(rng: np.random.Generator, picture: Picture, width_px: float) -> None:
    """Draw something wide at the border: a robot's arm, a box."""
    rows, columns = picture.shape
    side = rng.integers(0, 4)
    at = rng.random()
    middle = [(at * columns, 0), (at * columns, rows), (0, at * rows), (columns, at * rows)][side]
    axes = (rng.uniform(3.0, 12.0, 2) * width_px).astype(int)
    grey = float(rng.uniform(20.0, 255.0))
    centre = (int(middle[0]), int(middle[1]))
    turn = float(rng.uniform(0.0, 180.0))
    cv2.ellipse(picture, centre, (int(axes[0]), int(axes[1])), turn, 0, 360, grey, -1)
    for _ in range(int(rng.integers(0, 3))):
        inner = (axes * rng.uniform(0.3, 0.95)).astype(int)
        shade = float(np.clip(grey + rng.uniform(-70.0, 70.0), 0.0, 255.0))
        cv2.ellipse(
            picture,
            centre,
            (int(inner[0]), int(inner[1])),
            turn,
            0,
            360,
            shade,
            int(rng.choice([-1, 2])),
        )
