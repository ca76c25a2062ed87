"""The skeleton of a mask as a graph: edges are pieces of centre line, nodes where they meet."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from perception.cable.mask import CableMask
from perception.cable.skeleton import RING, thin
from perception.cable.types import Points

Pixel = tuple[int, int]
# One of the two ends of an edge: its number, and 0 for the first point or 1 for the last.
Arm = tuple[int, int]


@dataclass(frozen=True, slots=True, eq=False)
class Edge:
    """A piece of centre line between two nodes.

    Attributes:
        points_px: From node `nodes[0]` to node `nodes[1]`, shape (N, 2).
        radius_px: Distance to the border of the mask at each point, shape (N,).
        nodes: Numbers of its nodes.
    """

    points_px: Points
    radius_px: NDArray[np.float64]
    nodes: tuple[int, int]

    @property
    def length_px(self) -> float:
        """Length along the centre line."""
        return float(np.linalg.norm(np.diff(self.points_px, axis=0), axis=1).sum())

    def from_end(self, end: int) -> Points:
        """Return the points starting at one end."""
        return self.points_px if end == 0 else self.points_px[::-1]


@dataclass(frozen=True, slots=True, eq=False)
class SkeletonGraph:
    """Centre lines of everything that looks like cable.

    Attributes:
        edges: Pieces of centre line.
        nodes_px: Middle of each node, shape (K, 2).
        arms: For each node, the ends of edges that meet there.
    """

    edges: tuple[Edge, ...]
    nodes_px: Points
    arms: tuple[tuple[Arm, ...], ...]


def build_graph(mask: CableMask) -> SkeletonGraph:
    """Return the graph of the mask's skeleton; closed rings without a node are left out."""
    pixels = [(int(y), int(x)) for y, x in np.argwhere(thin(mask.cable))]
    around = _neighbours(pixels)
    node_of, middles = _nodes(pixels, around)
    edges = []
    for chain in _chains(around, node_of):
        points_px = np.array([(x, y) for y, x in chain], dtype=float)
        radius_px = np.array([mask.radius_px[pixel] for pixel in chain], dtype=float)
        ends = (node_of[chain[0]], node_of[chain[-1]])
        # An edge starts in the middle of its node, so that short edges keep their direction.
        points_px[0], points_px[-1] = middles[ends[0]], middles[ends[1]]
        edges.append(Edge(points_px, radius_px, ends))
    arms: list[list[Arm]] = [[] for _ in middles]
    for number, edge in enumerate(edges):
        arms[edge.nodes[0]].append((number, 0))
        arms[edge.nodes[1]].append((number, 1))
    return SkeletonGraph(tuple(edges), np.array(middles), tuple(tuple(arm) for arm in arms))


def _neighbours(pixels: list[Pixel]) -> dict[Pixel, list[Pixel]]:
    known = set(pixels)
    return {
        (y, x): [(y + dy, x + dx) for dy, dx in RING if (y + dy, x + dx) in known]
        for y, x in pixels
    }


def _nodes(
    pixels: list[Pixel], around: dict[Pixel, list[Pixel]]
) -> tuple[dict[Pixel, int], list[tuple[float, float]]]:
    """Return the node of each node pixel, and the middle (x, y) of each node."""
    node_of: dict[Pixel, int] = {}
    middles: list[tuple[float, float]] = []
    for seed in pixels:
        if len(around[seed]) == 2 or seed in node_of:
            continue
        group, stack = [], [seed]
        node_of[seed] = len(middles)
        while stack:
            pixel = stack.pop()
            group.append(pixel)
            for other in around[pixel]:
                if len(around[other]) > 2 and len(around[pixel]) > 2 and other not in node_of:
                    node_of[other] = len(middles)
                    stack.append(other)
        y, x = np.mean(group, axis=0)
        middles.append((float(x), float(y)))
    return node_of, middles


def _chains(around: dict[Pixel, list[Pixel]], node_of: dict[Pixel, int]) -> list[list[Pixel]]:
    """Return the pixels of every edge, node pixels at both ends included."""
    chains, walked = [], set()
    for start, node in node_of.items():
        for first in around[start]:
            if node_of.get(first) == node or (start, first) in walked:
                continue
            chain = [start, first]
            while chain[-1] not in node_of:
                here, before = chain[-1], chain[-2]
                chain.append(next(pixel for pixel in around[here] if pixel != before))
            walked.add((chain[0], chain[1]))
            walked.add((chain[-1], chain[-2]))
            chains.append(chain)
    return chains
