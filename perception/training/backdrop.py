"""What lies under and beside the cables: table, cloth, folds, clutter, robot parts."""

import cv2
import numpy as np
from numpy.typing import NDArray

from perception.training.clutter import draw_clutter
from perception.training.looks import Table
from perception.training.textures import checks, clouds, draw_texture

Floats = NDArray[np.float64]
Picture = NDArray[np.float32]


def draw_table(
    rng: np.random.Generator, size_px: tuple[int, int], table: Table, width_px: float
) -> Picture:
    """Return a table with its texture and what lies on it, shape `size_px`."""
    picture = np.full(size_px, table.level, np.float32)
    if table.texture > 0.0:
        strength = np.float32(table.texture * min(table.contrast, 110.0))
        picture += strength * draw_texture(rng, size_px, width_px)
    if table.chequered:
        strength = np.float32(rng.uniform(0.08, 0.3) * min(table.contrast, 120.0))
        picture += strength * checks(rng, size_px, width_px)
    if table.folds:
        _draw_cloth(rng, picture, table.contrast, width_px)
    if table.clutter:
        canvas = np.clip(picture, 0.0, 255.0).astype(np.uint8)
        draw_clutter(rng, canvas, width_px, table.clutter, table.cable)
        picture = canvas.astype(np.float32)
    return np.clip(picture, 0.0, 255.0)


def _draw_cloth(
    rng: np.random.Generator, picture: Picture, contrast: float, width_px: float
) -> None:
    share = np.float32(min(contrast / 100.0, 1.0))
    picture += share * clouds(rng, picture.shape, int(rng.integers(2, 6))) * rng.uniform(0.0, 16.0)
    for _ in range(int(rng.integers(0, 4))):
        _draw_fold(rng, picture, 22.0 * float(share), width_px)
    if rng.random() < 0.3:
        _draw_edge(rng, picture)
    if rng.random() < 0.35:
        for _ in range(int(rng.integers(1, 4))):
            _draw_part(rng, picture, width_px)


def _draw_fold(
    rng: np.random.Generator, picture: Picture, strength: float, width_px: float
) -> None:
    """Draw a soft line that is no cable: a fold, a seam, a scratch."""
    rows, columns = picture.shape
    ends = rng.uniform(0.0, 1.0, (2, 2)) * (columns, rows)
    points = np.linspace(ends[0], ends[1], 12) + rng.normal(0.0, 0.02 * rows, (12, 2))
    layer = np.zeros(picture.shape, np.float32)
    thickness = max(int(rng.uniform(0.2, 2.5) * width_px), 1)
    cv2.polylines(layer, [np.round(points).astype(np.int32)[:, None]], False, 1.0, thickness)
    side = (2 * max(round(rng.uniform(0.3, 1.0) * width_px), 1) + 1,) * 2
    soft = cv2.blur(cv2.blur(layer, side), side).astype(np.float32)
    picture += soft * np.float32(rng.uniform(-1.0, 1.0) * strength)


def _draw_edge(rng: np.random.Generator, picture: Picture) -> None:
    """Draw the border of a cloth: one part of the picture gets another level."""
    rows, columns = picture.shape
    turn = rng.uniform(0.0, 2.0 * np.pi)
    y, x = np.mgrid[:rows, :columns].astype(np.float32)
    away = np.cos(turn) * (x / columns - 0.5) + np.sin(turn) * (y / rows - 0.5)
    beyond = away > rng.uniform(0.25, 0.5)
    picture[beyond] += np.float32(rng.uniform(-60.0, 60.0))


def _draw_part(rng: np.random.Generator, picture: Picture, width_px: float) -> None:
    """Draw something wide at the border: a robot's arm with its fingers, a box."""
    rows, columns = picture.shape
    side, at = rng.integers(0, 4), rng.random()
    middle = [(at * columns, 0), (at * columns, rows), (0, at * rows), (columns, at * rows)][side]
    axes = rng.uniform(3.0, 12.0, 2) * width_px
    grey, turn = float(rng.uniform(20.0, 255.0)), float(rng.uniform(0.0, 180.0))
    if rng.random() < 0.4:
        _draw_fingers(rng, picture, np.array(middle), float(axes[0]), grey)
    for share in (1.0, *rng.uniform(0.3, 0.95, int(rng.integers(0, 3)))):
        centre, size = (int(middle[0]), int(middle[1])), (axes * share).astype(int)
        shade = grey if share == 1.0 else grey + rng.uniform(-70.0, 70.0)
        thickness = -1 if share == 1.0 else int(rng.choice([-1, 2]))
        level = float(np.clip(shade, 0.0, 255.0))
        cv2.ellipse(picture, centre, (int(size[0]), int(size[1])), turn, 0, 360, level, thickness)


def _draw_fingers(
    rng: np.random.Generator, picture: Picture, wrist: Floats, reach_px: float, grey: float
) -> None:
    """Draw two straight fingers that point inwards from a wrist at the border."""
    inwards = np.array(picture.shape[::-1]) / 2.0 - wrist
    inwards /= max(float(np.linalg.norm(inwards)), 1e-9)
    side = np.array([-inwards[1], inwards[0]]) * reach_px * rng.uniform(0.15, 0.4)
    tip = inwards * reach_px * rng.uniform(1.3, 2.2)
    for sign in (-1.0, 1.0):
        ends = np.round([wrist + sign * side, wrist + sign * side + tip]).astype(int)
        thickness = max(round(rng.uniform(0.12, 0.25) * reach_px), 2)
        cv2.line(picture, tuple(map(int, ends[0])), tuple(map(int, ends[1])), grey, thickness)
