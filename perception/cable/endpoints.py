"""Ends of cables: dead ends of the skeleton, with or without a connector.

A dead end at the border of the image or at clutter is cable that leaves the view, not an
end. Connectors are wider than the cable; the cable is taken to end where they start.
"""

import math
from dataclasses import dataclass

import numpy as np

from perception.cable.graph import Edge, SkeletonGraph, usual_radius
from perception.cable.mask import CableMask
from perception.cable.polyline import arc_lengths, point_at
from perception.cable.types import Endpoint, Points


@dataclass(frozen=True, slots=True)
class EndpointConfig:
    """Settings of the search for ends; lengths in cable widths.

    Attributes:
        border_px: A dead end nearer to the border of the image is cable that leaves it.
        support_widths: Shortest piece of cable behind an end.
        connector_widths: Longest connector.
        connector_ratio: A connector is this much wider than the cable.
        touching_widths: Shortest connector that is believed where it touches another strand.
        direction_widths: Length of cable that gives the direction.
    """

    border_px: float = 9.0
    support_widths: float = 2.5
    connector_widths: float = 8.0
    connector_ratio: float = 1.35
    touching_widths: float = 1.6
    direction_widths: float = 3.0


def find_endpoints(
    mask: CableMask, graph: SkeletonGraph, config: EndpointConfig | None = None
) -> tuple[Endpoint, ...]:
    """Return the ends of cables, the surest first."""
    config = config or EndpointConfig()
    found = []
    radius_px = usual_radius(graph)
    for node, arms in enumerate(graph.arms):
        if leaves_view(mask, graph.nodes_px[node], config.border_px):
            continue
        tips = [_tip(graph.edges[n], end, mask.width_px, radius_px, config) for n, end in arms]
        if len(tips) == 3:
            backs = [
                _tip(graph.edges[n], 1 - end, mask.width_px, radius_px, config) for n, end in arms
            ]
            tips = _touching(tips, backs, config.touching_widths * mask.width_px)
        if len(tips) == 1:
            found += [e for tip in tips if (e := _endpoint(tip, mask.width_px, config))]
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


@dataclass(frozen=True, slots=True, eq=False)
class _Tip:
    """The end of an edge, split into connector and cable.

    Attributes:
        points_px: The cable from its end inwards, shape (N, 2).
        wide_px: Length of what is wider than cable before it.
        is_connector: Whether that is a connector.
    """

    points_px: Points
    wide_px: float
    is_connector: bool


def _touching(tips: list[_Tip], backs: list[_Tip], shortest_px: float) -> list[_Tip]:
    """Return the connector among three arms that meet, where nothing else is wide.

    Two strands side by side are wide as well, but at both ends of where they run together.
    """
    wide = [k for k, tip in enumerate(tips) if tip.wide_px > shortest_px]
    return [
        tips[k]
        for k in wide
        if len(wide) == 1 and tips[k].is_connector and backs[k].wide_px <= shortest_px
    ]


def _tip(edge: Edge, end: int, width_px: float, radius_px: float, config: EndpointConfig) -> _Tip:
    points = edge.from_end(end)
    radii = edge.radius_px if end == 0 else edge.radius_px[::-1]
    arcs = arc_lengths(points)
    longest_px = config.connector_widths * width_px
    wide = np.flatnonzero((arcs < longest_px) & (radii > config.connector_ratio * radius_px))
    start = min(int(wide[-1]) + 1, len(arcs) - 1) if len(wide) else 0
    # Wide in places only is a kink, and wide up to the limit is a bundle of strands.
    is_connector = len(wide) > 0.6 * start and 0.5 * width_px < arcs[start] < 0.95 * longest_px
    return _Tip(points[start:] if is_connector else points, float(arcs[start]), is_connector)


def _endpoint(tip: _Tip, width_px: float, config: EndpointConfig) -> Endpoint | None:
    """Return the end of a cable; None where there is too little cable behind it."""
    arcs = arc_lengths(tip.points_px)
    support_px = float(arcs[-1])
    if support_px < config.support_widths * width_px:
        return None
    inner = point_at(tip.points_px, arcs, config.direction_widths * width_px)
    chord = inner - tip.points_px[0]
    direction = chord / max(float(np.linalg.norm(chord)), 1e-9)
    # More cable behind an end makes it surer, and so does a connector.
    evidence = 0.25 * (support_px / width_px - config.support_widths)
    evidence += 2.5 if tip.is_connector else 0.0
    probability = 1.0 / (1.0 + math.exp(-min(evidence, 4.0)))
    return Endpoint(tip.points_px[0].copy(), direction, probability)
