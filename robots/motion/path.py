"""Collision-free paths between configurations: edges, RRT-Connect, and shortcuts.

RRT-Connect is that of Kuffner and LaValle (ICRA 2000). Work is bounded by the number of
collision checks, not by time, so that a seed decides the answer.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robots.interfaces import Floats

# Largest sweep of the farthest part of an arm between two checks [m].
RESOLUTION_M = 0.02
_EXTENSION = 0.25  # of a tree, in the metric of the space
_SAMPLING_MARGIN_RAD = 3.0  # beyond the box around start and goal


@dataclass(frozen=True, slots=True, eq=False)
class Space:
    """The joints that move, between their limits, and the check of a configuration of theirs.

    Attributes:
        lower: Shape (n,) [rad].
        upper: Shape (n,) [rad].
        levers_m: How far the farthest moving part is from each joint's axis, shape (n,).
        collides: Answers for positions of shape (n,).
    """

    lower: Floats
    upper: Floats
    levers_m: Floats
    collides: Callable[[Floats], bool]

    def steps(self, a: Floats, b: Floats) -> int:
        """Return into how many steps an edge is cut so that nothing moves too far in one."""
        return 1 + int(self.levers_m @ np.abs(b - a) / RESOLUTION_M)

    def part(self, base: Floats, moving: NDArray[np.int64]) -> "Space":
        """Return the space of some of the joints, while the others stay as in `base`."""
        whole = base.copy()

        def collides(positions_rad: Floats) -> bool:
            whole[moving] = positions_rad
            return self.collides(whole)

        return Space(self.lower[moving], self.upper[moving], self.levers_m[moving], collides)

    def edge_is_free(self, a: Floats, b: Floats) -> bool:
        """Return whether the straight edge is free; `a` itself is taken to be."""
        count = self.steps(a, b)
        return not any(self.collides(a + (b - a) * (step / count)) for step in _coarse_first(count))


def _coarse_first(count: int) -> list[int]:
    """Return 1..count, the end first, then in strides that halve: obstacles show up early."""
    order, stride = [count], 1
    while 2 * stride < count:
        stride *= 2
    while stride:
        order += range(stride, count, 2 * stride)
        stride //= 2
    return order


def shorten(path: list[Floats], space: Space, rng: np.random.Generator, tries: int) -> list[Floats]:
    """Replace stretches of a path by straight edges where these are free.

    Args:
        path: Waypoints; not modified.
        space: Where the path lies.
        rng: Picks the stretches.
        tries: Stretches to try.
    """
    path = list(path)
    for _ in range(tries):
        if len(path) < 3:
            break
        first, last = sorted(rng.choice(len(path), 2, replace=False))
        if last - first < 2:
            continue
        if space.edge_is_free(path[first], path[last]):
            del path[first + 1 : last]
    return path


class RrtConnect:
    """Two trees that grow from start and goal until they meet."""

    def __init__(self, space: Space, rng: np.random.Generator, max_checks: int) -> None:
        """Take the space, the source of samples and how many collision checks may be spent."""
        self._space = space
        self._rng = rng
        self._left = max_checks

    def path(self, start: Floats, goal: Floats) -> list[Floats] | None:
        """Return waypoints from start to goal, or None when the checks are used up."""
        low = np.maximum(self._space.lower, np.minimum(start, goal) - _SAMPLING_MARGIN_RAD)
        high = np.minimum(self._space.upper, np.maximum(start, goal) + _SAMPLING_MARGIN_RAD)
        growing, other = _Tree(start, self._space.levers_m), _Tree(goal, self._space.levers_m)
        while self._left > 0:
            grown = self._extend(growing, self._rng.uniform(low, high))
            if grown is not None:
                target = growing.nodes[grown]
                met = self._connect(other, target)
                if met is not None:
                    halves = growing.branch(grown)[::-1], other.branch(met)[1:]
                    path = halves[0] + halves[1]
                    return path if np.array_equal(path[0], start) else path[::-1]
            growing, other = other, growing
        return None

    def _extend(self, tree: "_Tree", target: Floats) -> int | None:
        nearest = tree.nearest(target)
        origin = tree.nodes[nearest]
        distance = tree.distance(origin, target)
        if distance > _EXTENSION:
            target = origin + (target - origin) * (_EXTENSION / distance)
        self._left -= self._space.steps(origin, target)
        if not self._space.edge_is_free(origin, target):
            return None
        return tree.add(target, nearest)

    def _connect(self, tree: "_Tree", target: Floats) -> int | None:
        while self._left > 0:
            node = self._extend(tree, target)
            if node is None:
                return None
            if np.array_equal(tree.nodes[node], target):
                return node
        return None


class _Tree:
    """Nodes with their parents; distances weigh each joint by its lever."""

    def __init__(self, root: Floats, weights: Floats) -> None:
        self.nodes: list[Floats] = [root]
        self._parents = [0]
        self._weights = weights
        self._scaled: Floats = np.empty((256, len(root)))
        self._scaled[0] = root * weights

    def add(self, node: Floats, parent: int) -> int:
        index = len(self.nodes)
        if index == len(self._scaled):
            self._scaled = np.concatenate([self._scaled, np.empty_like(self._scaled)])
        self._scaled[index] = node * self._weights
        self.nodes.append(node)
        self._parents.append(parent)
        return index

    def nearest(self, target: Floats) -> int:
        gaps = self._scaled[: len(self.nodes)] - target * self._weights
        return int(np.argmin(np.einsum("ij,ij->i", gaps, gaps)))

    def distance(self, a: Floats, b: Floats) -> float:
        return float(np.linalg.norm((b - a) * self._weights))

    def branch(self, index: int) -> list[Floats]:
        """Return the nodes from one node to the root."""
        nodes = [self.nodes[index]]
        while index:
            index = self._parents[index]
            nodes.append(self.nodes[index])
        return nodes
