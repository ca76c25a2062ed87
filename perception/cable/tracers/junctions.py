"""Where strands meet in a skeleton, and the ways in which they may go on there.

A cable passes a crossing twice, so a graph of cables has an even number of arms at every
node. A skeleton often tears a crossing into two forks with a short bridge between them; both
strands run over the bridge. Which edges are such bridges is the postman's problem: double
the cheapest edges that leave no node odd. What stays odd is an end that lies on a strand.
"""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import networkx as nx
import numpy as np

from perception.cable.graph import Arm, Edge, SkeletonGraph, usual_radius
from perception.cable.polyline import arc_lengths, point_at
from perception.cable.types import Points


@dataclass(frozen=True, slots=True)
class JunctionConfig:
    """Settings of how strands may go on; lengths in cable widths, costs in nats.

    Attributes:
        thin_cost: Cost of a width of bridge that is no thicker than one strand.
        thick_cost: Cost of a width of bridge that is clearly thicker.
        thick_ratio: From here on an edge is clearly thicker, as a multiple of the usual radius.
        near_widths: Where on an arm its direction is measured from.
        far_widths: And to where.
        bend_cost: Cost of bending energy, the integral of curvature squared, times width.
        outlier_cost: From about here on a cost grows slower.
        loose_cost: Cost of a strand that ends at a junction.
        lost_cost: The same when connectors show both ends of the cable.
        hairpin_cost: Cost of a strand that turns back where two strands merge.
        most_arms: Nodes with more arms are paired greedily.
    """

    thin_cost: float = 2.2
    thick_cost: float = 0.35
    thick_ratio: float = 1.25
    near_widths: float = 0.8
    far_widths: float = 3.2
    bend_cost: float = 37.0
    outlier_cost: float = 8.0
    loose_cost: float = 7.0
    lost_cost: float = 25.0
    hairpin_cost: float = 2.0
    most_arms: int = 8


@dataclass(frozen=True, slots=True)
class Option:
    """One way in which the strands of a junction go on.

    Attributes:
        cost: Negative logarithm of its likelihood, up to a constant.
        pairs: Arms that belong together.
        loose: Arms that end here.
    """

    cost: float
    pairs: tuple[tuple[Arm, Arm], ...]
    loose: tuple[Arm, ...]


@dataclass(frozen=True, slots=True)
class Junction:
    """Nodes of the graph that are one place on the table.

    Attributes:
        nodes: Numbers of the nodes.
        arms: Ends of edges that leave it.
        options: Ways to go on, cheapest first.
    """

    nodes: tuple[int, ...]
    arms: tuple[Arm, ...]
    options: tuple[Option, ...]


@dataclass(frozen=True, slots=True)
class Junctions:
    """All junctions of a graph.

    Attributes:
        all: The junctions.
        bridges: Edges that two strands run over.
    """

    all: tuple[Junction, ...]
    bridges: frozenset[int]


def find_junctions(
    graph: SkeletonGraph, width_px: float, config: JunctionConfig | None = None
) -> Junctions:
    """Return the junctions of a graph with the ways in which strands go on."""
    config = config or JunctionConfig()
    if len(graph.plugs) > 1:
        config = replace(config, loose_cost=config.lost_cost)
    radius_px = usual_radius(graph)
    ratios = [float(edge.radius_px.mean()) / radius_px for edge in graph.edges]
    bridges = _bridges(graph, ratios, width_px, config)
    maker = _OptionMaker(graph, ratios, width_px, config)
    junctions = []
    for nodes in _groups(graph, bridges):
        arms = tuple(arm for node in nodes for arm in graph.arms[node] if arm[0] not in bridges)
        if arms:
            junctions.append(Junction(nodes, arms, maker.options(arms)))
    return Junctions(tuple(junctions), bridges)


def _bridges(
    graph: SkeletonGraph, ratios: Sequence[float], width_px: float, config: JunctionConfig
) -> frozenset[int]:
    """Return the edges to double so that as few nodes as possible stay odd.

    A way of doubled edges must cost less than the two loose ends that it saves.
    """
    roads: nx.Graph[int] = nx.Graph()
    for number, (edge, ratio) in enumerate(zip(graph.edges, ratios, strict=True)):
        a, b = edge.nodes
        thickness = min(max((ratio - 1.05) / (config.thick_ratio - 1.05), 0.0), 1.0)
        cost = config.thin_cost + thickness * (config.thick_cost - config.thin_cost)
        cost *= edge.length_px / width_px
        inner = len(graph.arms[a]) > 1 and len(graph.arms[b]) > 1 and a != b
        known = roads.get_edge_data(a, b, {"weight": math.inf})
        if inner and cost < min(2.0 * config.loose_cost, known["weight"]):
            roads.add_edge(a, b, weight=cost, number=number)
    odd = [node for node, arms in enumerate(graph.arms) if node in roads and len(arms) % 2]
    return _postman(roads, odd, 2.0 * config.loose_cost)


def _postman(roads: "nx.Graph[int]", odd: list[int], limit: float) -> frozenset[int]:
    """Return the edges of the cheapest ways between pairs of odd nodes, each below a limit."""
    wishes: nx.Graph[int] = nx.Graph()
    ways: dict[tuple[int, int], list[int]] = {}
    for a in odd:
        lengths, paths = nx.single_source_dijkstra(roads, a, cutoff=limit)
        for b in odd:
            if a < b and b in lengths:
                wishes.add_edge(a, b, weight=limit - lengths[b] + 1e-3)
                ways[a, b] = paths[b]
    doubled: set[int] = set()
    for a, b in sorted(map(sorted, nx.max_weight_matching(wishes))):
        path = ways[a, b]
        doubled ^= {roads[u][v]["number"] for u, v in itertools.pairwise(path)}
    return frozenset(doubled)


def _groups(graph: SkeletonGraph, bridges: frozenset[int]) -> list[tuple[int, ...]]:
    """Return nodes that bridges join, as groups."""
    joined: nx.Graph[int] = nx.Graph()
    joined.add_nodes_from(range(len(graph.arms)))
    joined.add_edges_from(graph.edges[number].nodes for number in bridges)
    return [tuple(sorted(group)) for group in nx.connected_components(joined)]


def arm_ray(edge: Edge, end: int, near_px: float, far_px: float) -> tuple[Points, Points]:
    """Return a point on an arm near its node, and the unit direction away from the node."""
    points = edge.from_end(end)
    along = arc_lengths(points)
    far = min(far_px, along[-1])
    near = min(near_px, 0.4 * far)
    a, b = point_at(points, along, np.array([near, far]))
    return a, (b - a) / max(float(np.linalg.norm(b - a)), 1e-9)


def turn_rad(a: Points, b: Points) -> float:
    """Return the angle from one direction to another, in [-pi, pi]."""
    return math.atan2(a[0] * b[1] - a[1] * b[0], float(a @ b))


class _OptionMaker:
    """Lists and rates the ways in which the arms of a junction can be paired."""

    def __init__(
        self,
        graph: SkeletonGraph,
        ratios: Sequence[float],
        width_px: float,
        config: JunctionConfig,
    ) -> None:
        self.graph, self.ratios, self.width_px, self.config = graph, ratios, width_px, config

    def options(self, arms: tuple[Arm, ...]) -> tuple[Option, ...]:
        if len(arms) == 1:
            return (Option(0.0, (), arms),)
        near_px, far_px = (
            widths * self.width_px for widths in (self.config.near_widths, self.config.far_widths)
        )
        rays = {arm: arm_ray(self.graph.edges[arm[0]], arm[1], near_px, far_px) for arm in arms}
        tips = [arm for arm in arms if self._is_tip(arm)]
        costs = {
            (a, b): self._bend_cost(rays[a], rays[b], bool(tips) and len(arms) == 3)
            for i, a in enumerate(arms)
            for b in arms[i + 1 :]
        }
        pairings = _pairings(arms) if len(arms) <= self.config.most_arms else [_greedy(arms, costs)]
        options = []
        for pairs, loose in pairings:
            cost = sum(costs[pair] for pair in pairs)
            cost += sum(0.0 if arm in tips else self.config.loose_cost for arm in loose)
            options.append(Option(cost, tuple(pairs), tuple(loose)))
        return tuple(sorted(options, key=lambda option: option.cost))

    def _is_tip(self, arm: Arm) -> bool:
        """Say whether an arm is the merged end of a narrow bend."""
        edge = self.graph.edges[arm[0]]
        dead = len(self.graph.arms[edge.nodes[1 - arm[1]]]) == 1
        thick = self.ratios[arm[0]] > self.config.thick_ratio
        return dead and thick and edge.length_px < 4.0 * self.width_px

    def _bend_cost(
        self, a: tuple[Points, Points], b: tuple[Points, Points], hairpin: bool
    ) -> float:
        """Return the cost of a strand that comes in along one arm and goes on along another.

        A cubic with end slopes p and q to its chord of length L has the bending energy
        4 (p^2 - p q + q^2) / L. Energy predicts where strands go better than turn or curvature
        do (multinomial fit to 539 crossings in rendered images).
        """
        chord = b[0] - a[0]
        p, q = turn_rad(-a[1], chord), turn_rad(chord, b[1])
        length_px = max(float(np.linalg.norm(chord)), self.width_px) * _arc_over_chord(p, q)
        energy = 4.0 * (p * p - p * q + q * q) / length_px * self.width_px
        cost = self._tempered(self.config.bend_cost * energy)
        return min(cost, self.config.hairpin_cost) if hairpin else cost

    def _tempered(self, cost: float) -> float:
        """Return a cost that grows slower where it is large, as outliers do happen."""
        return self.config.outlier_cost * math.log1p(cost / self.config.outlier_cost)


def _arc_over_chord(p: float, q: float) -> float:
    """Return how much longer than its chord an arc with these end slopes is."""
    half = min(0.5 * abs(p + q), 2.0)
    return half / math.sin(half) if half > 1e-3 else 1.0


def _pairings(
    arms: tuple[Arm, ...],
) -> Iterator[tuple[list[tuple[Arm, Arm]], list[Arm]]]:
    """Yield every way to pair arms; one stays alone where their number is odd."""
    if len(arms) % 2:
        for k, loose in enumerate(arms):
            for pairs, _ in _pairings(arms[:k] + arms[k + 1 :]):
                yield pairs, [loose]
        return
    if not arms:
        yield [], []
        return
    for k in range(1, len(arms)):
        for pairs, _ in _pairings(arms[1:k] + arms[k + 1 :]):
            yield [(arms[0], arms[k]), *pairs], []


def _greedy(
    arms: tuple[Arm, ...], costs: dict[tuple[Arm, Arm], float]
) -> tuple[list[tuple[Arm, Arm]], list[Arm]]:
    """Pair the straightest arms first."""
    left, pairs = set(arms), []
    for a, b in sorted(costs, key=lambda pair: costs[pair]):
        if a in left and b in left:
            pairs.append((a, b))
            left -= {a, b}
    return pairs, sorted(left)
