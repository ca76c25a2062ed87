"""Draw round strands into images, the highest one in front (Numba kernels)."""

import numba
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Images = NDArray[np.float32]


@numba.njit(cache=True, fastmath=True)
def splat(points: Floats, radius: float, label: float, height: Images, surface: Images) -> None:
    """Draw one strand into a height map and a surface map.

    Args:
        points: Centre line (x, y, z) [px], shape (N, 3).
        radius: Half its width [px].
        label: Number of the cable.
        height: Height of what is in front, shape (H, W).
        surface: What is in front: label, place across in [-1, 1], arc length [px], direction
            of the strand [rad]; shape (H, W, 4), or empty where only heights are asked for.
    """
    rows, columns = height.shape
    painted = surface.size > 0
    along = 0.0
    for k in range(len(points) - 1):
        ax, ay, az = points[k]
        ux, uy, uz = points[k + 1] - points[k]
        length = np.sqrt(ux * ux + uy * uy) + 1e-9
        direction = np.arctan2(uy, ux)
        first_x = max(int(np.floor(min(ax, ax + ux) - radius)), 0)
        last_x = min(int(np.ceil(max(ax, ax + ux) + radius)), columns - 1)
        first_y = max(int(np.floor(min(ay, ay + uy) - radius)), 0)
        last_y = min(int(np.ceil(max(ay, ay + uy) + radius)), rows - 1)
        for y in range(first_y, last_y + 1):
            for x in range(first_x, last_x + 1):
                px, py = x - ax, y - ay
                share = (px * ux + py * uy) / (length * length)
                share = min(max(share, 0.0), 1.0)
                dx, dy = px - share * ux, py - share * uy
                square = dx * dx + dy * dy
                if square > radius * radius:
                    continue
                top = az + share * uz + np.sqrt(radius * radius - square)
                if top > height[y, x]:
                    height[y, x] = top
                    if not painted:
                        continue
                    surface[y, x, 0] = label
                    surface[y, x, 1] = (px * uy - py * ux) / (length * radius)
                    surface[y, x, 2] = along + share * length
                    surface[y, x, 3] = direction
        along += length


@numba.njit(cache=True, fastmath=True)
def shade(picture: Images, height: Images, surface: Images, shadow: Images, looks: Floats) -> None:
    """Colour strands into a picture, and shadows onto them, in place.

    Args:
        picture: Grey values, shape (H, W).
        height: From `splat`; at most 0 where no strand is.
        surface: From `splat`.
        shadow: Height of what keeps the light off each pixel, at most 0 for nothing.
        looks: One row a cable: radius [px], brightness, braid amplitude, braid period [px],
            braid slope, flank darkening, gloss, light direction [rad], shadow strength,
            unevenness, dimming a pixel of height, gloss sharpness, stripe brightness over
            its own, stripe period [px], stripe slope, stripe share, outline darkening, bead
            darkening, bead period [px], loss of sides that turn away, flat sides of half a cable,
            angle of the light from straight above [rad].
    """
    rows, columns = height.shape
    for y in range(rows):
        for x in range(columns):
            if height[y, x] <= 0.0:
                continue
            look = looks[int(surface[y, x, 0])]
            across, along, direction = surface[y, x, 1], surface[y, x, 2], surface[y, x, 3]
            side = across * np.sin(look[7] - direction)
            value = look[1] * (1.0 - look[5] * across * across) * (1.0 + 0.25 * look[5] * side)
            if look[19] > 0.0:
                tilt = np.arcsin(min(max(across, -1.0), 1.0))
                if look[20] > 0.0:
                    step = np.pi / look[20]
                    tilt = (np.floor(tilt / step) + 0.5) * step
                lit = np.sin(tilt) * np.sin(look[7] - direction) * np.sin(look[21])
                lit += np.cos(tilt) * np.cos(look[21])
                value *= 1.0 - look[19] * (1.0 - max(lit, 0.0))
            if look[2] != 0.0:
                phase = 2.0 * np.pi * along / look[3]
                slope = look[4] * across
                value *= 1.0 + look[2] * np.sin(phase + slope) * np.sin(phase - slope)
            if look[12] != 1.0:
                turn = along / look[13] + look[14] * across / (2.0 * np.pi)
                if turn - np.floor(turn) < look[15]:
                    value *= look[12]
            if look[9] != 0.0:
                slow = 2.0 * np.pi * along / (look[0] * 2.0)
                value *= 1.0 + look[9] * (np.sin(0.11 * slow) + np.sin(0.043 * slow + 1.0))
            value *= max(1.0 + look[10] * (height[y, x] - 2.0 * look[0]), 0.5)
            if look[17] > 0.0:
                piece = along / look[18]
                value *= 1.0 - look[17] * (2.0 * abs(piece - np.floor(piece) - 0.5)) ** 6
            if look[6] > 0.0:
                off = across - 0.4 * np.sin(look[7] - direction)
                value += look[6] * np.exp(-look[11] * off * off)
            # A line of a pixel or a sixth of the width, whatever is more.
            if look[16] > 0.0 and abs(across) > 1.0 - max(0.33, 1.0 / look[0]):
                value *= 1.0 - look[16]
            if shadow[y, x] > height[y, x] + 0.3 * look[0]:
                value *= 1.0 - look[8]
            picture[y, x] = value
