"""Ends of cables: dead ends of the skeleton, with or without a connector.

A dead end at the border of the image or at clutter is cable that leaves the view, not an
end. Connectors are wider than the cable; the cable is taken to end where they start.
"""

import math
from dataclasses import dataclass

import numpy as np

from perception.cable.graph import Edge, SkeletonGraph, usual_radius
from perception.cable.mask import CableMask
from perception.cable.tracers.centre_line import arc_lengths
from perception.cable.types import Endpoint, Points


@dataclass(frozen=True, slots=True)
class EndpointConfig:
    """Settings of the search for ends; lengths in cable widths.

    Attributes:
        border_px: A dead end nearer to the border of the image is cable that leaves it.
        support_widths: Shortest piece of cable behind an end.
        connector_widths: Longest connector.
        connector_ratio: A connector is this much wider than the cable.
        direction_widths: Length of cable that gives the direction.
    """

    border_px: float = 9.0
    support_widths: float = 2.5
    connector_widths: float = 8.0
    connector_ratio: float = 1.35
    direction_widths: float = 3.0


def find_endpoints(
    mask: CableMask, graph: SkeletonGraph, config: EndpointConfig | None = None
) -> tuple[Endpoint, ...]:
    """Return the ends of cables, the surest first."""
    config = config or EndpointConfig()
    found = []
    radius_px = usual_radius(graph)
    for node, arms in enumerate(graph.arms):
        if len(arms) == 1 and not leaves_view(mask, graph.nodes_px[node], config.border_px):
            edge, end = graph.edges[arms[0][0]], arms[0][1]
            endpoint = _endpoint(edge, end, mask.width_px, radius_px, config)
            if endpoint is not None:
                found.append(endpoint)
    return tuple(sorted(found, key=lambda endpoint: -endpoint.probability))


def leaves_view(mask: CableMask, point_px: Points, border_px: float) -> bool:
    """Say whether cable that ends at a point may go on outside the view or behind clutter."""
    height, width = mask.cable.shape
    x, y = point_px
    if min(x, y, width - 1 - x, height - 1 - y) < border_px:
        return True
    reach = math.ceil(border_px)
    top, left = max(int(y) - reach, 0), max(int(x) - reach, 0)
    return bool(mask.clutter[top : int(y) + reach + 1, left : int(x) + reach + 1].any())


def _endpoint(
    edge: Edge, end: int, width_px: float, radius_px: float, config: EndpointConfig
) -> Endpoint | None:
    points = edge.from_end(end)
    radii = edge.radius_px if end == 0 else edge.radius_px[::-1]
    arcs = arc_lengths(points)
    start = _cable_start(radii, arcs, config.connector_widths * width_px, radius_px, config)
    support_px = float(arcs[-1] - arcs[start])
    if support_px < config.support_widths * width_px:
        return None
    reach_px = min(config.direction_widths * width_px, support_px)
    inner = int(np.searchsorted(arcs, arcs[start] + reach_px))
    chord = points[min(inner, len(points) - 1)] - points[start]
    direction = chord / max(float(np.linalg.norm(chord)), 1e-9)
    # More cable behind an end makes it surer, and so does a connector.
    evidence = 0.25 * (support_px / width_px - config.support_widths)
    evidence += 2.5 if start > 0 else 0.0
    probability = 1.0 / (1.0 + math.exp(-min(evidence, 4.0)))
    return Endpoint(points[start].copy(), direction, probability)


def _cable_start(
    radii: Points, arcs: Points, longest_px: float, radius_px: float, config: EndpointConfig
) -> int:
    """Return the index where the connector ends and the cable starts; 0 without connector."""
    near = arcs < longest_px
    wide = np.flatnonzero(near & (radii > config.connector_ratio * radius_px))
    if len(wide) < 0.25 * longest_px / config.connector_widths:
        return 0
    start = min(int(wide[-1]) + 1, len(arcs) - 1)
    # Wide up to the limit is a bundle of strands, not a connector.
    return start if arcs[start] < 0.95 * longest_px else 0
