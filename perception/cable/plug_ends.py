"""Connectors in the graph of centre lines, whatever lies over, under or beside them.

Each connector becomes a node. Strands that run into it end there as arms; the connector itself
is one more edge, from the node to a dead end. How strands pass is then the business of the
tracer, as at any other crossing: the connector is the strand that the cable's end goes on into.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from perception.cable.endpoints import EndpointConfig, find_endpoints
from perception.cable.graph import Edge, SkeletonGraph, arms_of, usual_radius
from perception.cable.mask import CableMask
from perception.cable.plugs import Plug
from perception.cable.polyline import arc_lengths, pixels_of, point_at
from perception.cable.types import Endpoint, Points

# How sure it is that a connector is the end of a cable.
PLUG_PROBABILITY = 0.99
# Dead ends of centre lines nearer than this to a connector, in cable widths, are parts of it.
CLEAR_WIDTHS = 4.0


@dataclass(frozen=True, slots=True)
class PlugEndConfig:
    """Settings of connectors in a graph; lengths in cable widths.

    Attributes:
        reach_widths: Centre lines this near to a body belong to it.
        stump_widths: Pieces up to this long that lead from a body to nowhere are parts of it.
        direction_widths: Length of strand that gives its direction.
        thick_ratio: An edge is two strands from this multiple of the usual radius on.
    """

    reach_widths: float = 1.2
    stump_widths: float = 3.5
    direction_widths: float = 3.0
    thick_ratio: float = 1.25


def with_plugs(
    graph: SkeletonGraph,
    plugs: Sequence[Plug],
    width_px: float,
    config: PlugEndConfig | None = None,
) -> SkeletonGraph:
    """Return the graph with an edge for each connector; it starts at the free end."""
    config = config or PlugEndConfig()
    for plug in plugs:
        graph = _with_plug(graph, plug, width_px, config)
    return graph


def find_ends(
    mask: CableMask, graph: SkeletonGraph, config: EndpointConfig | None = None
) -> tuple[Endpoint, ...]:
    """Return the ends of cables: connectors first, then dead ends away from them."""
    plugs = [graph.edges[number] for number in sorted(graph.plugs)]
    at_plugs = np.concatenate([np.empty((0, 2)), *(plug.points_px for plug in plugs)])
    bare = [
        end
        for end in find_endpoints(mask, graph, config)
        if (np.linalg.norm(at_plugs - end.position_px, axis=1) > CLEAR_WIDTHS * mask.width_px).all()
    ]
    return (*map(_end_of, plugs), *bare)


def _end_of(plug: Edge) -> Endpoint:
    chord = plug.points_px[-1] - plug.points_px[0]
    return Endpoint(plug.points_px[-1].copy(), chord / np.linalg.norm(chord), PLUG_PROBABILITY)


def _with_plug(
    graph: SkeletonGraph, plug: Plug, width_px: float, config: PlugEndConfig
) -> SkeletonGraph:
    """Return the graph with one more connector; as it was where no cable comes to it."""
    node = len(graph.nodes_px)
    gaps_px = cv2.distanceTransform((~plug.body).astype(np.uint8), cv2.DIST_L2, 3)
    kept: list[Edge] = []
    stubs: set[int] = set()
    for number, edge in enumerate(graph.edges):
        # A smoothed edge may lie half a pixel outside the image.
        near = gaps_px[pixels_of(edge.points_px, gaps_px.shape)] <= config.reach_widths * width_px
        pieces = [edge] if not near.any() or number in graph.plugs else _outside(edge, near, node)
        for piece in pieces:
            if number in graph.plugs:
                stubs.add(len(kept))
            if not _is_stump(graph, piece, node, config.stump_widths * width_px):
                kept.append(piece)
    arms = list(_arms_at(kept, node))
    if not arms:
        return graph
    stubs.add(len(kept))
    stub = _stub(plug, arms, node, usual_radius(graph), config.direction_widths * width_px, config)
    nodes_px = np.vstack([graph.nodes_px, stub.points_px[[-1, 0]]])
    return _compact([*kept, stub], nodes_px, stubs)


def _outside(
    edge: Edge, near: "np.ndarray[tuple[int], np.dtype[np.bool_]]", node: int
) -> list[Edge]:
    """Return the parts of an edge away from a connector; their cut ends are at its node."""
    bounds = np.flatnonzero(np.diff(np.concatenate([[True], near, [True]]).astype(int)))
    parts = []
    for begin, stop in zip(bounds[::2], bounds[1::2], strict=True):
        if stop - begin < 2:
            continue
        ends = (
            edge.nodes[0] if begin == 0 else node,
            edge.nodes[1] if stop == len(near) else node,
        )
        parts.append(Edge(edge.points_px[begin:stop], edge.radius_px[begin:stop], ends))
    return parts


def _is_stump(graph: SkeletonGraph, edge: Edge, node: int, longest_px: float) -> bool:
    """Say whether an edge leads from a connector to nowhere, or back to it, in a short way."""
    if node not in edge.nodes or edge.length_px > longest_px:
        return False
    other = edge.nodes[1] if edge.nodes[0] == node else edge.nodes[0]
    return other == node or len(graph.arms[other]) == 1


def _arms_at(edges: Sequence[Edge], node: int) -> Iterator[Edge]:
    """Yield the edges at a node, once for each end that they have there, that end first."""
    for edge in edges:
        if edge.nodes[0] == node:
            yield edge
        if edge.nodes[1] == node:
            yield edge.reversed()


def _stub(
    plug: Plug,
    arms: Sequence[Edge],
    node: int,
    radius_px: float,
    direction_px: float,
    config: PlugEndConfig,
) -> Edge:
    """Return the connector as an edge from its free end to where the cable enters it.

    A strand that passes leaves as much as it comes, so the directions of all arms add up to
    that of the cable; an arm that is two strands counts twice.
    """
    flow = 0.0
    for arm in arms:
        inner = point_at(arm.points_px, arc_lengths(arm.points_px), direction_px)
        chord = inner - arm.points_px[0]
        near = arc_lengths(arm.points_px) < direction_px
        strands = 2.0 if np.median(arm.radius_px[near]) > config.thick_ratio * radius_px else 1.0
        flow += strands * float(chord @ plug.axis) / max(float(np.linalg.norm(chord)), 1e-9)
    inwards = plug.axis if flow >= 0.0 else -plug.axis
    along = np.linspace(-plug.half_length_px, plug.half_length_px, 12)[:, None]
    points_px: Points = plug.centre_px + along * inwards
    return Edge(points_px, np.full(len(points_px), radius_px), (node + 1, node))


def _compact(edges: Sequence[Edge], nodes_px: Points, stubs: set[int]) -> SkeletonGraph:
    """Return the graph of the edges; nodes without any are left out."""
    numbers = sorted({node for edge in edges for node in edge.nodes})
    new = {node: k for k, node in enumerate(numbers)}
    edges = [replace(edge, nodes=(new[edge.nodes[0]], new[edge.nodes[1]])) for edge in edges]
    return SkeletonGraph(
        tuple(edges), nodes_px[numbers], arms_of(edges, len(numbers)), frozenset(stubs)
    )
