"""Moving overlapping objects apart on a shelf.

Thesis, section 7.2: objects are moved along the displacement between them, again and again, and a
scene that takes too long is given up; here after a number of rounds and not of seconds, so that a
seed gives the same scene on every machine. Plain arithmetic alone, for the same reason.
"""

import math

import numpy as np

from perception.shelf.types import Floats, Shelf

ROUNDS = 200
# Between objects that were moved apart; more than positions are rounded by.
CLEARANCE_M = 0.002
# From walls; the same.
WALL_M = 1e-5


def separate(centres_m: Floats, sizes_m: Floats, shelf: Shelf) -> Floats | None:
    """Move footprints apart, and into the shelf.

    Args:
        centres_m: Centres (x, y), shape (N, 2).
        sizes_m: Sizes (width, depth), shape (N, 2).
        shelf: The shelf; every object fits into it alone.

    Returns:
        New centres, shape (N, 2), or None where they still overlap after the last round.
    """
    half = 0.5 * sizes_m
    low, high = half + WALL_M, np.array([shelf.width_m, shelf.depth_m]) - half - WALL_M
    places = np.clip(centres_m, low, high)
    for _ in range(ROUNDS):
        pairs = _overlaps(places, half)
        if not pairs:
            return places
        for first, second in pairs:
            _part(places, half, first, second)
            for index in (first, second):
                places[index] = np.clip(places[index], low[index], high[index])
    return None


def _overlaps(places: Floats, half: Floats) -> list[tuple[int, int]]:
    apart = np.abs(places[:, None] - places[None])
    closer = (apart < half[:, None] + half[None] + CLEARANCE_M).all(axis=2)
    return [(int(i), int(j)) for i, j in np.argwhere(np.triu(closer, 1))]


def _part(places: Floats, half: Floats, first: int, second: int) -> None:
    """Move two objects along their displacement, half of what is missing each."""
    dx = float(places[second, 0] - places[first, 0])
    dy = float(places[second, 1] - places[first, 1])
    length = math.sqrt(dx * dx + dy * dy)
    ux, uy = (dx / length, dy / length) if length > 0.0 else (1.0, 0.0)
    need = half[first] + half[second] + 1.5 * CLEARANCE_M
    ways = [
        (float(required) - abs(gap)) / abs(unit)
        for required, gap, unit in ((need[0], dx, ux), (need[1], dy, uy))
        if abs(unit) > 1e-9
    ]
    step = 0.5 * min(ways)
    if step <= 0.0:
        return
    move = np.array([step * ux, step * uy])
    places[first] -= move
    places[second] += move
