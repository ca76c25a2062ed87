"""A lazy roadmap: random free configurations, edges that are checked only when they are needed.

After R. Bohlin and L. E. Kavraki, "Path Planning Using Lazy PRM", ICRA 2000. It samples all of the
joints' range, and densely beside obstacles (V. Boor, M. H. Overmars and A. F. van der Stappen,
"The Gaussian Sampling Strategy", ICRA 1999), where trees that grow from start and goal seldom get.
"""

import heapq
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from robots.interfaces import Floats
from robots.motion.path import Space

NEIGHBOURS = 12
# Of all checks, this share goes into samples.
_SAMPLING_SHARE = 0.05
_NEAR_RAD = 0.3


@dataclass(slots=True)
class Roadmap:
    """Looks for a path over a roadmap.

    Attributes:
        space: Where the path lies.
        rng: Source of samples.
        max_checks: Collision checks that may be spent.
    """

    space: Space
    rng: np.random.Generator
    max_checks: int

    def path(self, start: Floats, goal: Floats) -> list[Floats] | None:
        """Return waypoints from start to goal, or None when the checks are used up."""
        left = self.max_checks
        samples, spent = self._samples(int(_SAMPLING_SHARE * left))
        left -= spent
        nodes = np.array([start, goal, *samples])
        gaps = _gaps(nodes * self.space.levers_m)
        links = _links(gaps)
        shut = np.zeros(gaps.shape, dtype=bool)
        known = shut.copy()
        while left > 0:
            way = _shortest(gaps, links, shut)
            if way is None:
                return None
            doubtful = [(a, b) for a, b in pairwise(way) if not known[a, b]]
            if not doubtful:
                return [nodes[k] for k in way]
            for a, b in doubtful:
                left -= self.space.steps(nodes[a], nodes[b])
                free = self.space.edge_is_free(nodes[a], nodes[b])
                known[a, b] = known[b, a] = True
                shut[a, b] = shut[b, a] = not free
                if not free:
                    break
        return None

    def _samples(self, checks: int) -> tuple[list[Floats], int]:
        """Return free configurations, every other one beside an obstacle, and checks spent."""
        free: list[Floats] = []
        low, high = self.space.lower, self.space.upper
        for spent in range(0, checks, 2):
            q = self.rng.uniform(low, high)
            beside = np.clip(q + _NEAR_RAD * self.rng.standard_normal(len(q)), low, high)
            hits = self.space.collides(q), self.space.collides(beside)
            if hits[0] != hits[1]:
                free.append(beside if hits[0] else q)
            elif not hits[0] and spent % 4 == 0:
                free.append(q)
        return free, checks


def _gaps(scaled: Floats) -> Floats:
    squares = np.einsum("ij,ij->i", scaled, scaled)
    between = squares[:, None] + squares[None] - 2.0 * scaled @ scaled.T
    return np.asarray(np.sqrt(np.maximum(between, 0.0)))


def _links(gaps: Floats) -> list[list[int]]:
    """Return the nodes that each node has edges with: its nearest, and those it is nearest of."""
    linked: list[set[int]] = [set() for _ in gaps]
    for a, row in enumerate(np.argsort(gaps, axis=1)[:, 1 : NEIGHBOURS + 1].tolist()):
        for b in row:
            linked[a].add(b)
            linked[b].add(a)
    return [sorted(others) for others in linked]


def _shortest(
    gaps: Floats, links: Sequence[Sequence[int]], shut: NDArray[np.bool_]
) -> list[int] | None:
    """Return the shortest way from node 0 to node 1 over edges that are not known to be shut.

    It is A* (P. Hart, N. Nilsson and B. Raphael 1968) with straight distances.
    """
    queue, cost, parent = [(float(gaps[0, 1]), 0)], {0: 0.0}, {0: 0}
    done: set[int] = set()
    while queue:
        _, node = heapq.heappop(queue)
        if node == 1:
            return [*_branch(parent, node)][::-1]
        if node in done:
            continue
        done.add(node)
        for other in links[node]:
            way = cost[node] + float(gaps[node, other])
            if not shut[node, other] and way < cost.get(other, np.inf):
                cost[other], parent[other] = way, node
                heapq.heappush(queue, (way + float(gaps[other, 1]), other))
    return None


def _branch(parent: dict[int, int], node: int) -> Iterator[int]:
    yield node
    while node:
        node = parent[node]
        yield node
