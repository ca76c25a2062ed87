"""Lift strands over each other until no two of them share a place.

Cables are chains of balls of one cable width. Which strand goes over is chosen first, as a
small difference of height; balls that overlap then push each other away (position-based
dynamics without inertia), so neighbouring strands part sideways and crossing ones upwards.
"""

import numba
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

NEAR = 2.0
SKIP = 4


@numba.njit(cache=True)
def crossings(xy: Floats, cable: Ints) -> Floats:
    """Return (position of one strand, of the other) as node numbers with fractions."""
    found = []
    n = len(xy)
    for i in range(n - 1):
        if cable[i] != cable[i + 1]:
            continue
        ax, ay = xy[i]
        ux, uy = xy[i + 1, 0] - ax, xy[i + 1, 1] - ay
        for j in range(i + 2, n - 1):
            bx, by = xy[j]
            if cable[j] != cable[j + 1] or abs(bx - ax) > 1.5 or abs(by - ay) > 1.5:
                continue
            vx, vy = xy[j + 1, 0] - bx, xy[j + 1, 1] - by
            area = ux * vy - uy * vx
            if abs(area) < 1e-12:
                continue
            s = ((bx - ax) * vy - (by - ay) * vx) / area
            t = ((bx - ax) * uy - (by - ay) * ux) / area
            if 0.0 <= s < 1.0 and 0.0 <= t < 1.0:
                found.append((i + s, j + t))
    out = np.empty((len(found), 2))
    for k in range(len(found)):
        out[k, 0], out[k, 1] = found[k]
    return out


@numba.njit(cache=True)
def near_pairs(xy: Floats, cable: Ints) -> Ints:
    """Return pairs of balls that may touch."""
    found = []
    for i in range(len(xy)):
        for j in range(i + 1, len(xy)):
            if cable[i] == cable[j] and j - i < SKIP:
                continue
            dx, dy = xy[i, 0] - xy[j, 0], xy[i, 1] - xy[j, 1]
            if abs(dx) < NEAR and abs(dy) < NEAR:
                found.append((i, j))
    out = np.empty((len(found), 2), dtype=np.int64)
    for k in range(len(found)):
        out[k, 0], out[k, 1] = found[k]
    return out


@numba.njit(cache=True)
def settle(nodes: Floats, cable: Ints, pairs: Ints, rounds: int, widths: Floats) -> None:
    """Push overlapping balls apart, in place.

    Args:
        nodes: Balls (x, y, z), the table at height 0, shape (N, 3).
        cable: Which cable each belongs to, shape (N,).
        pairs: From `near_pairs`.
        rounds: How often all pairs are pushed.
        widths: Diameter of the balls of each cable.
    """
    n = len(nodes)
    for _ in range(rounds):
        for k in range(len(pairs)):
            i, j = pairs[k]
            dx, dy = nodes[i, 0] - nodes[j, 0], nodes[i, 1] - nodes[j, 1]
            dz = nodes[i, 2] - nodes[j, 2]
            distance = np.sqrt(dx * dx + dy * dy + dz * dz)
            least = 0.5 * (widths[cable[i]] + widths[cable[j]])
            if 1e-6 < distance < least:
                push = 0.4 * (least - distance) / distance
                nodes[i, 0] += push * dx
                nodes[i, 1] += push * dy
                nodes[i, 2] += push * dz
                nodes[j, 0] -= push * dx
                nodes[j, 1] -= push * dy
                nodes[j, 2] -= push * dz
        for i in range(1, n - 1):
            if cable[i - 1] == cable[i] and cable[i] == cable[i + 1]:
                for axis in range(3):
                    middle = 0.5 * (nodes[i - 1, axis] + nodes[i + 1, axis])
                    nodes[i, axis] += 0.3 * (middle - nodes[i, axis])
            nodes[i, 2] = max(nodes[i, 2] - 0.01, 0.5 * widths[cable[i]])
