"""Where objects of a shelf are meant to stand, before they are moved apart.

Thesis, section 7.2. What it leaves open is decided here: the children of a node are shuffled and
cut where their leaves are shared most evenly, and each part is cut again until it is one child;
"horizontally" is a cut into left and right; each object draws its own noise at each cut; a child
that is an object alone gets its sub-shelf to itself.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from perception.shelf.types import Floats, Shelf, Size

# With more objects than this below a node, its shelf is cut into left and right.
CROWD = 8


@dataclass(frozen=True, slots=True)
class Leaf:
    """One object to be placed.

    Attributes:
        index: Its number.
        category: Its path in the taxonomy.
        size_m: Its size.
    """

    index: int
    category: tuple[str, ...]
    size_m: Size


@dataclass(frozen=True, slots=True)
class _Region:
    low_m: tuple[float, float]
    high_m: tuple[float, float]

    def halves(self, axis: int) -> "tuple[_Region, _Region]":
        """Cut in the middle."""
        middle_m = 0.5 * (self.low_m[axis] + self.high_m[axis])
        end, start = list(self.high_m), list(self.low_m)
        end[axis] = start[axis] = middle_m
        return _Region(self.low_m, (end[0], end[1])), _Region((start[0], start[1]), self.high_m)


def shelf_places(
    leaves: Sequence[Leaf],
    shelf: Shelf,
    organisation: float,
    noise_m: float,
    rng: np.random.Generator,
) -> Floats:
    """Draw where objects are meant to stand; they may still overlap.

    Args:
        leaves: The objects, numbered from 0.
        shelf: The shelf.
        organisation: The share of objects that stand where the taxonomy puts them; the others
            stand anywhere. 1 is the thesis's arrangement, 0 its RAND.
        noise_m: Largest noise a cut adds to a place.
        rng: Source of chance.

    Returns:
        Centres (x, y) [m], shape (N, 2).
    """
    whole = _Region((0.0, 0.0), (shelf.width_m, shelf.depth_m))
    places_m = np.zeros((len(leaves), 2))
    _arrange(list(leaves), 0, whole, noise_m, places_m, rng)
    for leaf in leaves:
        if rng.random() >= organisation:
            places_m[leaf.index] = _anywhere(leaf, whole, rng)
    return places_m


def _arrange(
    leaves: list[Leaf],
    level: int,
    region: _Region,
    noise_m: float,
    places_m: Floats,
    rng: np.random.Generator,
) -> None:
    """Place the objects below one node."""
    children = _children(leaves, level)
    if all(len(leaf.category) <= level for leaf in leaves):
        for leaf in leaves:
            places_m[leaf.index] += _anywhere(leaf, region, rng)
        return
    order = rng.permutation(len(children))
    _cut([children[index] for index in order], level, region, noise_m, places_m, rng)


def _cut(
    children: list[list[Leaf]],
    level: int,
    region: _Region,
    noise_m: float,
    places_m: Floats,
    rng: np.random.Generator,
) -> None:
    """Share a region among the children of a node."""
    if len(children) == 1:
        _arrange(children[0], level + 1, region, noise_m, places_m, rng)
        return
    counts = np.cumsum([len(child) for child in children])
    middle = 1 + int(np.argmin(np.abs(2 * counts[:-1] - counts[-1])))
    axis = 0 if counts[-1] > CROWD or rng.random() < 0.5 else 1
    for child in children:
        for leaf in child:
            places_m[leaf.index] += noise_m * (2.0 * rng.random(2) - 1.0)
    for part, half in zip((children[:middle], children[middle:]), region.halves(axis), strict=True):
        _cut(part, level, half, noise_m, places_m, rng)


def _children(leaves: list[Leaf], level: int) -> list[list[Leaf]]:
    """Group objects by the next name on their paths; those at their end are on their own."""
    groups: dict[str, list[Leaf]] = {}
    alone: list[list[Leaf]] = []
    for leaf in leaves:
        if len(leaf.category) > level:
            groups.setdefault(leaf.category[level], []).append(leaf)
        else:
            alone.append([leaf])
    return [*groups.values(), *alone]


def _anywhere(leaf: Leaf, region: _Region, rng: np.random.Generator) -> Floats:
    """Draw a place inside a region, or its middle where the object is too large for it."""
    half = 0.5 * np.array(leaf.size_m[:2])
    low, high = np.array(region.low_m) + half, np.array(region.high_m) - half
    middle = 0.5 * (low + high)
    low, high = np.minimum(low, middle), np.maximum(high, middle)
    inside = (np.array(region.high_m) - np.array(region.low_m)) >= 2.0 * half
    return np.where(inside, low + rng.random(2) * (high - low), middle)
