"""Cage and pinch points of a knot (thesis, section 3.4).

The pinch lies on the strand that closes the knot on top, the cage on the strand that opens
it below. Both are looked for between undercrossings, at lonely cable: away from crossings,
and with room on both sides for two fingers.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from perception.cable.polyline import arc_lengths, point_at
from perception.cable.types import Crossing, Knot, Points, Trace

STEP_PX = 4.0


@dataclass(frozen=True, slots=True)
class GraspConfig:
    """Settings of the search for grasp points.

    Attributes:
        room_px: Wanted distance to other strands, for two fingers of about 12 mm.
        crossing_px: Wanted distance to crossings along the strand.
        apart_px: Smallest distance between cage and pinch.
        own_px: Cable nearer than this along the trace is the held piece itself.
        farther_px: How far the search goes on beyond its region when that has no room.
    """

    room_px: float = 18.0
    crossing_px: float = 20.0
    apart_px: float = 60.0
    own_px: float = 36.0
    farther_px: float = 260.0


@dataclass(frozen=True, slots=True, eq=False)
class _Strand:
    """A trace prepared for grasping."""

    line: Points
    arcs: Points
    others: Points
    own_crossings_px: Points
    unders_px: Points
    config: GraspConfig

    def clearance(self, at_px: float) -> float:
        """Return the distance to the nearest other strand, reduced near crossings."""
        here = point_at(self.line, self.arcs, at_px)
        far = np.abs(self.arcs - at_px) > self.config.own_px
        near_px = float(np.linalg.norm(self.line[far] - here, axis=1).min(initial=1e3))
        if len(self.others):
            near_px = min(near_px, float(np.linalg.norm(self.others - here, axis=1).min()))
        gap_px = float(np.abs(self.own_crossings_px - at_px).min(initial=1e3))
        scale = self.config.room_px / self.config.crossing_px
        return min(near_px, gap_px * scale)

    def direction(self, at_px: float) -> Points:
        """Return the unit tangent."""
        ends = point_at(self.line, self.arcs, np.array([at_px - 6.0, at_px + 6.0]))
        unit: Points = (ends[1] - ends[0]) / max(float(np.linalg.norm(ends[1] - ends[0])), 1e-9)
        return unit


def choose_grasps(
    traces: Sequence[Trace],
    index: int,
    crossings: Sequence[Crossing],
    interval: tuple[float, float],
    config: GraspConfig,
) -> Knot:
    """Return the knot over `interval` of one trace with its cage and pinch points."""
    strand = _prepare(traces, index, crossings, config)
    length_px = float(strand.arcs[-1])
    begin_px, end_px = interval[0] * length_px, interval[1] * length_px
    pinch_px = _pinch(strand, begin_px, end_px)
    cage_px = _cage(strand, begin_px, end_px, point_at(strand.line, strand.arcs, pinch_px))
    return Knot(
        trace=index,
        interval=interval,
        first_undercrossing_px=point_at(strand.line, strand.arcs, begin_px),
        cage_px=point_at(strand.line, strand.arcs, cage_px),
        pinch_px=point_at(strand.line, strand.arcs, pinch_px),
        cage_direction=strand.direction(cage_px),
        pinch_direction=strand.direction(pinch_px),
    )


def _prepare(
    traces: Sequence[Trace], index: int, crossings: Sequence[Crossing], config: GraspConfig
) -> _Strand:
    line = traces[index].points_px
    arcs = arc_lengths(line)
    overs = [c.arc_over for c in crossings if c.trace_over == index]
    unders = [c.arc_under for c in crossings if c.trace_under == index]
    others = [trace.points_px for k, trace in enumerate(traces) if k != index]
    return _Strand(
        line,
        arcs,
        np.concatenate(others) if others else np.empty((0, 2)),
        np.array(overs + unders) * arcs[-1],
        np.sort(np.array(unders)) * arcs[-1],
        config,
    )


def _pinch(strand: _Strand, begin_px: float, end_px: float) -> float:
    """Search between the last undercrossing of the knot and the next one after it."""
    inside = strand.unders_px[(strand.unders_px > begin_px + 1.0) & (strand.unders_px < end_px)]
    after = strand.unders_px[strand.unders_px > end_px]
    low = float(inside.max(initial=begin_px))
    high = float(after.min(initial=strand.arcs[-1]))
    region = np.arange(low, high, STEP_PX)
    beyond = np.arange(high, high + strand.config.farther_px, STEP_PX)
    return _most_graspable(strand, region, beyond, end_px, None)


def _cage(strand: _Strand, begin_px: float, end_px: float, pinch: Points) -> float:
    """Search from the first undercrossing to the next one inside the knot."""
    inside = strand.unders_px[(strand.unders_px > begin_px + 1.0) & (strand.unders_px < end_px)]
    high = float(inside.min(initial=end_px))
    region = np.arange(begin_px, high, STEP_PX)
    beyond = np.arange(high, high + strand.config.farther_px, STEP_PX)
    return _most_graspable(strand, region, beyond, begin_px, pinch)


def _most_graspable(
    strand: _Strand, region: Points, beyond: Points, near_px: float, apart_from: Points | None
) -> float:
    """Return the roomiest place of a region, or the first good one beyond, or the best of all."""
    best: tuple[float, float] | None = None
    for places in (region, beyond):
        rated = [
            (min(strand.clearance(at), strand.config.room_px) - 0.01 * abs(at - near_px), float(at))
            for at in places
            if 0.0 <= at <= strand.arcs[-1] and _is_apart(strand, at, apart_from)
        ]
        top = max(rated, default=None)
        if top is not None and (best is None or top[0] > best[0]):
            best = top
        if best is not None and strand.clearance(best[1]) >= strand.config.room_px:
            return best[1]
    return best[1] if best is not None else near_px


def _is_apart(strand: _Strand, at_px: float, other: Points | None) -> bool:
    if other is None:
        return True
    gap_px = float(np.linalg.norm(point_at(strand.line, strand.arcs, at_px) - other))
    return gap_px >= strand.config.apart_px
