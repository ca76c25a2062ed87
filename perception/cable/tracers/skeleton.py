"""The tracer of the whole scene: thread every cable at once, then read off the one asked for.

A greedy tracer decides each crossing when it gets there. Here every crossing is decided with
all others in view: each piece of cable belongs to exactly one strand, strands pass crossings
as straight as they can, and none may close on itself. Rival threadings give probabilities.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field

import networkx as nx
import numpy as np

from perception.cable.endpoints import leaves_view
from perception.cable.graph import Arm, SkeletonGraph
from perception.cable.mask import CableMask
from perception.cable.observation import Observation, Observe, observe
from perception.cable.polyline import arc_lengths, point_at, resample
from perception.cable.tracers.centre_line import bend_between, smooth
from perception.cable.tracers.junctions import JunctionConfig, Junctions, find_junctions
from perception.cable.tracers.transitions import (
    Threading,
    ThreadingConfig,
    best_threadings,
    strand_probabilities,
    walk,
)
from perception.cable.types import Endpoint, Points, Trace, TraceEnd
from perception.camera import GreyImage


@dataclass(frozen=True, slots=True)
class SkeletonTracerConfig:
    """Settings of the skeleton tracer; lengths in cable widths.

    Attributes:
        junctions: How strands may go on where they meet.
        threading: The search over all junctions.
        cut_widths: The skeleton this near to a junction is bent by it and is left out.
        direction_widths: Length of strand that gives its direction at a junction.
        smoothing_widths: Standard deviation of the smoothing along the centre line.
        start_widths: Farthest a start may lie from the cable.
        end_widths: Farthest an endpoint may lie from the trace that finishes at it.
        connector_widths: Longest piece of trace beyond an endpoint.
        border_px: A trace that ends nearer to the border has left the view.
        shortest_widths: Strands shorter than this are no cables.
    """

    junctions: JunctionConfig = field(default_factory=JunctionConfig)
    threading: ThreadingConfig = field(default_factory=ThreadingConfig)
    cut_widths: float = 0.9
    direction_widths: float = 1.2
    smoothing_widths: float = 0.6
    start_widths: float = 2.5
    end_widths: float = 2.0
    connector_widths: float = 9.0
    border_px: float = 9.0
    shortest_widths: float = 10.0


class SkeletonTracer:
    """Implements `Tracer` on the skeleton graph of the cable mask.

    Args:
        config: Settings.
        observe: Looks at an image.
    """

    def __init__(
        self, config: SkeletonTracerConfig | None = None, observe: Observe = observe
    ) -> None:
        self._config, self._observe = config or SkeletonTracerConfig(), observe

    def trace(
        self, image: GreyImage, start_px: Points, endpoints: Sequence[Endpoint]
    ) -> Trace | None:
        """Follow the cable; see `Tracer.trace`."""
        observation = self._observe(image)
        return self.trace_observed(observation, start_px, endpoints) if observation else None

    def trace_observed(
        self, observation: Observation, start_px: Points, endpoints: Sequence[Endpoint]
    ) -> Trace | None:
        """Follow the cable in an image that has been looked at already."""
        mask, graph, config = observation.mask, observation.graph, self._config
        start_px = np.atleast_2d(np.asarray(start_px, dtype=float))
        start = _find_start(graph, start_px, config.start_widths * mask.width_px)
        if start is None:
            return None
        junctions = find_junctions(graph, mask.width_px, config.junctions)
        threadings = best_threadings(junctions.all, config.threading)
        leaving, offset = start
        arms, probability = strand_probabilities(threadings, leaving)[0]
        line = _Line(mask, graph, junctions, config).draw(arms, offset)
        if arc_lengths(line)[-1] < mask.width_px:
            return None
        end, line = self._end(mask, arms, line, endpoints)
        return Trace(line, end, probability)

    def strands_observed(self, observation: Observation) -> tuple[Trace, ...]:
        """Return every cable in view, longest first, each as one trace from either end."""
        mask, graph, config = observation.mask, observation.graph, self._config
        junctions = find_junctions(graph, mask.width_px, config.junctions)
        threadings = best_threadings(junctions.all, config.threading)
        drawing = _Line(mask, graph, junctions, config)
        traces = []
        for leaving in _first_arms(graph, junctions, threadings[0]):
            arms, probability = strand_probabilities(threadings, leaving)[0]
            line = drawing.draw(arms, 0.0)
            if arc_lengths(line)[-1] > config.shortest_widths * mask.width_px:
                traces.append(Trace(line, self._end(mask, arms, line, ())[0], probability))
        return tuple(sorted(traces, key=lambda trace: -float(arc_lengths(trace.points_px)[-1])))

    def _end(
        self,
        mask: CableMask,
        arms: Sequence[Arm],
        line: Points,
        endpoints: Sequence[Endpoint],
    ) -> tuple[TraceEnd, Points]:
        """Return why a strand ends, and its line without the connector."""
        if len(set(arms)) < len(arms):
            return TraceEnd.RETRACE, line
        cut = _reached(
            line,
            endpoints,
            self._config.end_widths * mask.width_px,
            self._config.connector_widths * mask.width_px,
        )
        if cut is not None:
            return TraceEnd.ENDPOINT, line[: cut + 1]
        if leaves_view(mask, line[-1], self._config.border_px):
            return TraceEnd.EDGE, line
        return TraceEnd.LOST, line


def _first_arms(graph: SkeletonGraph, junctions: Junctions, threading: Threading) -> list[Arm]:
    """Return an arm for each strand of a threading, by which it leaves its first edge."""
    seen: set[Arm] = set()
    first = []
    arms = [(number, end) for number in range(len(graph.edges)) for end in (0, 1)]
    loose = [arm for arm in arms if arm[0] not in junctions.bridges]
    # Where a strand begins nothing leads in; what is left after those are rings.
    beginnings = [(n, 1 - end) for n, end in loose if (n, end) not in threading.partners]
    for arm in beginnings + loose:
        if arm in seen:
            continue
        first.append(arm)
        passed = walk(threading.partners, arm)
        seen |= {(number, end) for number, _ in passed for end in (0, 1)}
    return first


def _find_start(
    graph: SkeletonGraph, start_px: Points, farthest_px: float
) -> tuple[Arm, float] | None:
    """Return the arm through which the first edge is left, and where on it tracing starts.

    The place is an arc length from the end opposite to that arm.
    """
    best: tuple[float, Arm, float] | None = None
    for number, edge in enumerate(graph.edges):
        gaps = np.linalg.norm(edge.points_px - start_px[0], axis=1)
        k = int(np.argmin(gaps))
        if best is not None and gaps[k] >= best[0]:
            continue
        arcs = arc_lengths(edge.points_px)
        if _runs_forward(graph, number, k, start_px):
            best = (float(gaps[k]), (number, 1), float(arcs[k]))
        else:
            best = (float(gaps[k]), (number, 0), float(arcs[-1] - arcs[k]))
    return best[1:] if best is not None and best[0] <= farthest_px else None


def _runs_forward(graph: SkeletonGraph, number: int, k: int, start_px: Points) -> bool:
    """Say whether the start follows an edge from its first to its last point."""
    edge = graph.edges[number]
    if len(start_px) > 1:
        towards = start_px[1:] - start_px[0]
        tangent = (
            edge.points_px[min(k + 5, len(edge.points_px) - 1)] - edge.points_px[max(k - 5, 0)]
        )
        return float((towards @ tangent).sum()) >= 0.0
    dead = [len(graph.arms[node]) == 1 for node in edge.nodes]
    return dead[0] if dead[0] != dead[1] else k < len(edge.points_px) / 2


def _reached(
    line: Points, endpoints: Sequence[Endpoint], near_px: float, tail_px: float
) -> int | None:
    """Return where on a line it reaches an endpoint, near its end; None where it does not."""
    arcs = arc_lengths(line)
    tail = np.flatnonzero((arcs > arcs[-1] - tail_px) & (arcs > 0.5 * arcs[-1]))
    best: tuple[float, int] | None = None
    for endpoint in endpoints:
        gaps = np.linalg.norm(line[tail] - endpoint.position_px, axis=1)
        k = int(np.argmin(gaps))
        if gaps[k] <= near_px and (best is None or gaps[k] < best[0]):
            best = (float(gaps[k]), int(tail[k]))
    return None if best is None else best[1]


class _Line:
    """Draws the centre line of a strand."""

    def __init__(
        self,
        mask: CableMask,
        graph: SkeletonGraph,
        junctions: Junctions,
        config: SkeletonTracerConfig,
    ) -> None:
        self.mask, self.graph, self.config = mask, graph, config
        self.bridges: nx.Graph[int] = nx.Graph()
        for number in junctions.bridges:
            a, b = graph.edges[number].nodes
            self.bridges.add_edge(a, b, number=number, weight=graph.edges[number].length_px)

    def draw(self, arms: Sequence[Arm], offset_px: float) -> Points:
        """Return the smoothed line that leaves edges through `arms`, the first one partly."""
        pieces = [
            self._edge(arm, first=k == 0, offset_px=offset_px, last=k == len(arms) - 1)
            for k, arm in enumerate(arms)
        ]
        rough, reach_px = [pieces[0]], self.config.direction_widths * self.mask.width_px
        for k in range(1, len(arms)):
            entered = (arms[k][0], 1 - arms[k][1])
            bundle = self._bridge(arms[k - 1], entered, rough[-1], pieces[k])
            for piece in (bundle, pieces[k]):
                if len(piece):
                    rough.append(bend_between(rough[-1], piece, reach_px))
                    rough.append(piece)
        line = np.concatenate(rough)
        return smooth(line, self.config.smoothing_widths * self.mask.width_px)

    def _edge(self, arm: Arm, *, first: bool, offset_px: float, last: bool) -> Points:
        """Return an edge towards `arm`, cut where junctions bend it."""
        points = resample(self.graph.edges[arm[0]].from_end(1 - arm[1]), 1.0)
        arcs = arc_lengths(points)
        cut_px = min(self.config.cut_widths * self.mask.width_px, 0.35 * arcs[-1])
        begin = offset_px if first else cut_px
        end = arcs[-1] if last else max(arcs[-1] - cut_px, begin)
        kept = points[(arcs >= begin) & (arcs <= end)]
        return kept if len(kept) else point_at(points, arcs, np.array([min(begin, arcs[-1])]))

    def _bridge(self, left: Arm, entered: Arm, before: Points, after: Points) -> Points:
        """Return points along the bridge between two arms, moved to the strand's own side."""
        a = self.graph.edges[left[0]].nodes[left[1]]
        b = self.graph.edges[entered[0]].nodes[entered[1]]
        if a == b or a not in self.bridges or b not in self.bridges:
            return np.empty((0, 2))
        nodes = nx.shortest_path(self.bridges, a, b, weight="weight")
        middle = np.concatenate([self._bridge_points(u, v) for u, v in itertools.pairwise(nodes)])
        length_px = float(arc_lengths(middle)[-1])
        if length_px < 3.0 * self.mask.width_px:
            return np.empty((0, 2))
        return self._beside(middle, before[-1], after[0])

    def _bridge_points(self, a: int, b: int) -> Points:
        edge = self.graph.edges[self.bridges[a][b]["number"]]
        return edge.points_px if edge.nodes[0] == a else edge.points_px[::-1]

    def _beside(self, middle: Points, entry: Points, exit_: Points) -> Points:
        """Return the middle of a bundle, moved from the entry's side over to the exit's side."""
        limit_px = 0.35 * self.mask.width_px
        reach = max(int(2.0 * self.mask.width_px), 1)
        ahead = np.minimum(np.arange(len(middle)) + reach, len(middle) - 1)
        behind = np.maximum(np.arange(len(middle)) - reach, 0)
        chords = middle[ahead] - middle[behind]
        normals = np.column_stack([-chords[:, 1], chords[:, 0]])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-9)
        sides = [
            float(np.clip((point - middle[k]) @ normals[k], -limit_px, limit_px))
            for k, point in ((0, entry), (-1, exit_))
        ]
        share = np.linspace(0.0, 1.0, len(middle))[:, None]
        moved: Points = middle + normals * (sides[0] + (sides[1] - sides[0]) * share)
        return moved[reach // 2 : len(moved) - reach // 2]
