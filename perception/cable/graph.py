"""The skeleton of a mask as a graph: edges are pieces of centre line, nodes where they meet."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from perception.cable.mask import CableMask
from perception.cable.skeleton import RING, thin
from perception.cable.types import Points

Pixel = tuple[int, int]
# One of the two ends of an edge: its number, and 0 for the first point or 1 for the last.
Arm = tuple[int, int]
# A dead end is a spur up to this many radii of the mask, and widths of the cable, of length.
SPUR_RADII = 1.0
SPUR_WIDTHS = 0.9
# No cable bends to a ring as short as this; connectors with dark parts show such rings.
RING_WIDTHS = 5.0


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

    def reversed(self) -> "Edge":
        """Return the same edge the other way round."""
        return Edge(self.points_px[::-1], self.radius_px[::-1], (self.nodes[1], self.nodes[0]))


@dataclass(frozen=True, slots=True, eq=False)
class SkeletonGraph:
    """Centre lines of everything that looks like cable.

    Attributes:
        edges: Pieces of centre line.
        nodes_px: Middle of each node, shape (K, 2).
        arms: For each node, the ends of edges that meet there.
        plugs: Numbers of the edges that are connectors; they start at the connector's free end.
    """

    edges: tuple[Edge, ...]
    nodes_px: Points
    arms: tuple[tuple[Arm, ...], ...]
    plugs: frozenset[int] = frozenset()


def build_graph(mask: CableMask) -> SkeletonGraph:
    """Return the graph of the mask's skeleton; closed rings without a node are left out.

    Short dead ends, which a skeleton has at every corner of the mask, are cut off.
    """
    edges, middles = _raw_edges(mask)
    edges = _without_spurs(edges, mask.width_px)
    edges = _joined(edges)
    numbers = sorted({node for edge in edges for node in edge.nodes})
    new = {node: k for k, node in enumerate(numbers)}
    edges = [replace(edge, nodes=(new[edge.nodes[0]], new[edge.nodes[1]])) for edge in edges]
    nodes_px = np.array([middles[node] for node in numbers]).reshape(-1, 2)
    return SkeletonGraph(tuple(edges), nodes_px, arms_of(edges, len(numbers)))


def _raw_edges(mask: CableMask) -> tuple[list[Edge], list[tuple[float, float]]]:
    """Return the edges of the skeleton as it is, and the middles of its nodes."""
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
    return edges, middles


def arms_of(edges: Sequence[Edge], count: int) -> tuple[tuple[Arm, ...], ...]:
    """Return for each of `count` nodes the ends of edges that meet there."""
    arms: list[list[Arm]] = [[] for _ in range(count)]
    for number, edge in enumerate(edges):
        arms[edge.nodes[0]].append((number, 0))
        arms[edge.nodes[1]].append((number, 1))
    return tuple(map(tuple, arms))


def _without_spurs(edges: list[Edge], width_px: float) -> list[Edge]:
    """Drop dead ends no longer than the mask is wide where they branch off, and tiny rings."""
    count = max((node for edge in edges for node in edge.nodes), default=-1) + 1
    degree = [len(arms) for arms in arms_of(edges, count)]
    kept = []
    for edge in edges:
        if edge.nodes[0] == edge.nodes[1] and edge.length_px < RING_WIDTHS * width_px:
            continue
        degrees = [degree[node] for node in edge.nodes]
        inner_radius_px = float(edge.radius_px[int(degrees[0] == 1) * -1])
        longest_px = SPUR_RADII * inner_radius_px + SPUR_WIDTHS * width_px
        if sorted(min(d, 2) for d in degrees) != [1, 2] or edge.length_px > longest_px:
            kept.append(edge)
    return kept


def _joined(edges: list[Edge]) -> list[Edge]:
    """Join pairs of edges that meet where nothing else does."""
    count = max((node for edge in edges for node in edge.nodes), default=-1) + 1
    alive = dict(enumerate(edges))
    at: list[set[int]] = [set() for _ in range(count)]
    loops: set[int] = set()
    for number, edge in alive.items():
        at[edge.nodes[0]].add(number)
        at[edge.nodes[1]].add(number)
        if edge.nodes[0] == edge.nodes[1]:
            loops.add(edge.nodes[0])
    for node in range(count):
        if len(at[node]) != 2 or node in loops:
            continue
        a, b = sorted(at[node])
        joined = _join(alive.pop(a), alive.pop(b), node)
        for end in joined.nodes:
            at[end] = (at[end] - {a, b}) | {a}
        if joined.nodes[0] == joined.nodes[1]:
            loops.add(joined.nodes[0])
        alive[a] = joined
    return list(alive.values())


def _join(a: Edge, b: Edge, node: int) -> Edge:
    """Return the edge that runs along `a` to a node and on along `b`."""
    a = a if a.nodes[1] == node else a.reversed()
    b = b if b.nodes[0] == node else b.reversed()
    return Edge(
        np.concatenate([a.points_px, b.points_px[1:]]),
        np.concatenate([a.radius_px, b.radius_px[1:]]),
        (a.nodes[0], b.nodes[1]),
    )


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


def usual_radius(graph: SkeletonGraph) -> float:
    """Return the radius of a single strand: the median along all edges."""
    return float(np.median(np.concatenate([edge.radius_px for edge in graph.edges])))
