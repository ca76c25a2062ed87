"""Textures of tables: cloth, wood, stone, prints; each of mean 0 and deviation near 1."""

from collections.abc import Callable

import cv2
import numpy as np
from numpy.typing import NDArray

Picture = NDArray[np.float32]
Size = tuple[int, int]


def clouds(rng: np.random.Generator, size_px: Size, cells: int) -> Picture:
    """Return smooth noise with a number of cells a side."""
    coarse = rng.standard_normal((cells, cells)).astype(np.float32)
    return cv2.resize(coarse, size_px[::-1], interpolation=cv2.INTER_CUBIC).astype(np.float32)


def _turned(rng: np.random.Generator, size_px: Size) -> tuple[Picture, Picture]:
    """Return coordinates [px] along two axes at a right angle, turned at random."""
    turn = rng.uniform(0.0, np.pi)
    x = np.arange(size_px[1], dtype=np.float32)
    y = np.arange(size_px[0], dtype=np.float32)[:, None]
    c, s = np.float32(np.cos(turn)), np.float32(np.sin(turn))
    return c * x + s * y, c * y - s * x


def _weave(rng: np.random.Generator, size_px: Size, _: float) -> Picture:
    """Return threads that go over and under."""
    u, v = _turned(rng, size_px)
    scale = np.float32(2.0 * np.pi / rng.uniform(2.2, 9.0))
    stripes: Picture = np.sin(u * scale)
    if rng.random() < 0.4:
        return 1.4 * stripes
    return 2.0 * stripes * np.sin(v * scale)


def _fractal(rng: np.random.Generator, size_px: Size, _: float) -> Picture:
    """Return noise of several scales, each `fall` times as strong as the next coarser one."""
    fall, cells, weight = rng.uniform(0.45, 1.0), int(rng.integers(2, 5)), 1.0
    total, power = np.zeros(size_px, np.float32), 0.0
    while cells < max(size_px) / 2:
        total += np.float32(weight) * clouds(rng, size_px, cells)
        power += weight * weight
        weight, cells = weight * fall, cells * 3
    return total / np.float32(np.sqrt(power))


def _wood(rng: np.random.Generator, size_px: Size, width_px: float) -> Picture:
    """Return boards with grain along them and seams between them."""
    _, v = _turned(rng, size_px)
    wander = clouds(rng, size_px, 4) * np.float32(rng.uniform(0.5, 4.0) * width_px)
    across = v + wander
    grain = np.sin(across * np.float32(2.0 * np.pi / (rng.uniform(0.6, 3.0) * width_px)))
    fine = rng.standard_normal((size_px[0] // 2 + 1, 12)).astype(np.float32)
    streaks = cv2.resize(fine, size_px[::-1], interpolation=cv2.INTER_LINEAR)
    wood: Picture = (0.8 * (grain + streaks)).astype(np.float32)
    board = np.floor(v / np.float32(rng.uniform(8.0, 25.0) * width_px)).astype(np.int64)
    tones = rng.normal(0.0, 0.6, int(np.ptp(board)) + 1).astype(np.float32)
    return wood + tones[board - board.min()]


def _stripes(rng: np.random.Generator, size_px: Size, width_px: float) -> Picture:
    """Return broad stripes, never of a cable's width."""
    u, _ = _turned(rng, size_px)
    period = rng.choice([rng.uniform(0.3, 0.8), rng.uniform(4.0, 14.0)]) * width_px
    bars = np.sign(np.sin(u * np.float32(2.0 * np.pi / max(period, 2.5))))
    return bars.astype(np.float32)


def checks(rng: np.random.Generator, size_px: Size, width_px: float) -> Picture:
    """Return a chequered ground."""
    u, v = _turned(rng, size_px)
    scale = np.float32(np.pi / (rng.uniform(3.0, 16.0) * width_px))
    squares: Picture = np.sign(np.sin(u * scale) * np.sin(v * scale)).astype(np.float32)
    return squares


def _speckle(rng: np.random.Generator, size_px: Size, width_px: float) -> Picture:
    """Return grains, as stone and printed board have them."""
    finer = max(int(rng.uniform(0.1, 0.5) * width_px), 1)
    small = (size_px[0] // finer + 1, size_px[1] // finer + 1)
    noise = rng.standard_normal(small, dtype=np.float32)
    grains = np.where(np.abs(noise) > rng.uniform(1.0, 2.2), 2.0 * np.sign(noise), 0.0)
    large = cv2.resize(grains, size_px[::-1], interpolation=cv2.INTER_LINEAR)
    return large.astype(np.float32)


def _dots(rng: np.random.Generator, size_px: Size, width_px: float) -> Picture:
    """Return a regular print of dots."""
    u, v = _turned(rng, size_px)
    scale = np.float32(2.0 * np.pi / (rng.uniform(0.8, 6.0) * width_px))
    level = rng.uniform(0.2, 1.5)
    print_: Picture = np.where(np.cos(u * scale) + np.cos(v * scale) > level, 2.0, -0.3)
    return print_.astype(np.float32)


def _smooth(rng: np.random.Generator, size_px: Size, _: float) -> Picture:
    return clouds(rng, size_px, int(rng.integers(3, 40)))


_TEXTURES: tuple[Callable[[np.random.Generator, Size, float], Picture], ...] = (
    _smooth,
    _weave,
    _fractal,
    _wood,
    _stripes,
    _speckle,
    _dots,
    checks,
)


def draw_texture(rng: np.random.Generator, size_px: Size, width_px: float) -> Picture:
    """Return one texture, or two of them over each other.

    Args:
        rng: Source of all randomness.
        size_px: Height and width.
        width_px: Width of the cables, by which some textures are scaled.
    """
    first, second = rng.integers(len(_TEXTURES), size=2)
    texture = _TEXTURES[first](rng, size_px, width_px)
    if rng.random() < 0.3:
        texture = 0.7 * (texture + _TEXTURES[second](rng, size_px, width_px))
    return texture
