"""Objects that stand on others: which may, and where on top of them they come to stand."""

import numpy as np

from perception.shelf.types import Box, Floats, Shelf, Size

# Between what stands on top and the board above it.
HEADROOM_M = 0.03
# A tower that is more than so many times as high as it is wide or deep stands badly.
SLENDER = 4.0


def stacks(
    meant_m: Floats, sizes_m: Floats, share: float, shelf: Shelf, rng: np.random.Generator
) -> dict[int, int]:
    """Draw which objects stand on which; none stands on one that stands on another.

    Each stands on what is meant to stand nearest to it of those that can carry it wholly.

    Args:
        meant_m: Where objects are meant to stand on the floor, shape (N, 2).
        sizes_m: Width, depth and height, shape (N, 3).
        share: The share of objects that are to stand on another.
        shelf: The shelf.
        rng: Source of chance.

    Returns:
        The carrier of each object that stands on one, by number.
    """
    carriers: dict[int, int] = {}
    wanted = round(share * len(sizes_m))
    for upper in rng.permutation(len(sizes_m)).tolist():
        if len(carriers) == wanted:
            break
        if upper in carriers.values():
            continue
        able = [
            lower
            for lower in range(len(sizes_m))
            if lower != upper
            and lower not in carriers
            and lower not in carriers.values()
            and _carries(sizes_m[lower], sizes_m[upper], shelf)
        ]
        if able:
            far_m = np.hypot(*(meant_m[able] - meant_m[upper]).T)
            carriers[upper] = able[int(far_m.argmin())]
    return carriers


def put_on(size_m: Size, carrier: Box, rng: np.random.Generator, decimals: int) -> Box:
    """Return where an object of some size stands on a carrier: anywhere that it is wholly on it."""
    play_m = 0.5 * (np.array(carrier.size_m[:2]) - size_m[:2])
    x_m, y_m = (np.array([carrier.x_m, carrier.y_m]) + rng.uniform(-play_m, play_m)).tolist()
    return Box(round(x_m, decimals), round(y_m, decimals), size_m, carrier.size_m[2])


def _carries(lower_m: Floats, upper_m: Floats, shelf: Shelf) -> bool:
    """Say whether one object can carry another."""
    high_m = float(lower_m[2] + upper_m[2])
    fits = bool((upper_m[:2] <= lower_m[:2]).all()) and high_m + HEADROOM_M <= shelf.height_m
    return fits and high_m <= SLENDER * float(lower_m[:2].min())
