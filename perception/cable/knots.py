"""Knots of traced cables, and where to hold them.

The thesis's rule names places that look like knots. Here a piece of cable counts only when
its diagram, closed over everything, is proved to be knotted; the shortest such pieces are
the knots. As what lies on top at either end of a piece can be taken off, each begins with an
undercrossing.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from perception.cable.belief import NOTHING_KNOWN, knotted_share, reading_of, told
from perception.cable.crossings import strand_of
from perception.cable.grasp_points import (
    CablePixels,
    CagePinch,
    GraspConfig,
    GraspPolicy,
    HeldStrand,
    held_strand,
)
from perception.cable.grasp_room import RoomPolicy
from perception.cable.grasp_tusk import TuskPolicy
from perception.cable.outcomes import outcomes
from perception.cable.polyline import arc_lengths, point_at
from perception.cable.topology import (
    Knottedness,
    Strand,
    StrandCrossing,
    classify_diagram,
    close_over,
)
from perception.cable.topology.names import UNKNOT, UNKNOWN
from perception.cable.topology.rule import Visit
from perception.cable.types import Crossing, Knot, Points, Reading, Trace

# A piece is cut this far beyond its first and last crossing.
MARGIN_PX = 4.0
# Where all crossings are at least this sure, they are taken as they are.
SURE = 0.99


def find_knots(
    traces: Sequence[Trace],
    crossings: Sequence[Crossing],
    config: GraspConfig | None = None,
    pixels: CablePixels | None = None,
) -> tuple[Knot, ...]:
    """Return the knots of all traces in the order of the traces, and where to hold each.

    Args:
        traces: The traces.
        crossings: Their crossings.
        config: How cage and pinch are searched for.
        pixels: What is cable in the image; only the thesis's search needs it.

    Raises:
        ValueError: The search needs them, and there are none.
    """
    if not traces:
        return ()
    policy = grasp_policy(config or GraspConfig(), pixels)
    return tuple(
        held_knot(policy, strand, index, interval)
        for index in range(len(traces))
        for strand in (held_strand(traces, index, crossings),)
        for interval in knot_intervals(traces[index], index, crossings)
    )


def grasp_policy(config: GraspConfig, pixels: CablePixels | None = None) -> GraspPolicy:
    """Return the search for cage and pinch that the settings name.

    Raises:
        ValueError: It counts pixels of cable, and there are none.
    """
    if config.policy == "room":
        return RoomPolicy(config)
    if pixels is None:
        raise ValueError(
            "grasp_policy: policy 'tusk' counts pixels of cable; got none; expected the mask of "
            "the image; try: policy 'room', which goes by traces alone"
        )
    return TuskPolicy(pixels)


def choose_grasps(
    policy: GraspPolicy, strand: HeldStrand, interval: tuple[float, float]
) -> CagePinch:
    """Return cage and pinch of the knot over an interval of arc positions, and their flaw."""
    return policy.choose(strand, interval[0] * strand.length_px, interval[1] * strand.length_px)


def held_knot(
    policy: GraspPolicy, strand: HeldStrand, index: int, interval: tuple[float, float]
) -> Knot:
    """Return the knot over an interval of a trace, held where a policy chooses."""
    grasps = choose_grasps(policy, strand, interval)
    return Knot(
        trace=index,
        interval=interval,
        first_undercrossing_px=strand.point(interval[0] * strand.length_px),
        cage_px=strand.point(grasps.cage_px),
        pinch_px=strand.point(grasps.pinch_px),
        cage_direction=strand.direction(grasps.cage_px),
        pinch_direction=strand.direction(grasps.pinch_px),
    )


def knot_intervals(
    trace: Trace, index: int, crossings: Sequence[Crossing]
) -> list[tuple[float, float]]:
    """Return for each knot of a trace where it is entered below and closed on top."""
    own = likeliest_together(reading_of(trace, index, crossings))
    visits = visits_of(own)
    search = _Search(strand_of(trace, index, own), visits)
    return [_entry_and_close(visits, first, last) for first, last in search.knotted_pieces()]


def likeliest_together(reading: Reading) -> tuple[Crossing, ...]:
    """Return a reading's crossings as they lie in its likeliest diagram.

    The answers that are likeliest one by one may make a knot that all others together speak
    against, or the other way round. What is believed of the knot is decided first, then the
    likeliest combination that agrees with it.
    """
    if all(crossing.probability >= SURE for crossing in reading.crossings):
        return reading.crossings
    listed = outcomes(reading)
    knotted = knotted_share(told(listed)) > NOTHING_KNOWN
    for flipped, name in zip(listed.flipped, listed.knots, strict=True):
        if name != UNKNOWN and (name != UNKNOT) == knotted:
            pairs = zip(listed.crossings, flipped, strict=True)
            return tuple(_flipped(crossing) if flip else crossing for crossing, flip in pairs)
    return reading.crossings


def _flipped(crossing: Crossing) -> Crossing:
    return replace(
        crossing,
        trace_over=crossing.trace_under,
        arc_over=crossing.arc_under,
        trace_under=crossing.trace_over,
        arc_under=crossing.arc_over,
    )


def visits_of(crossings: Sequence[Crossing]) -> list[Visit]:
    """Return the visits of one trace's crossings with itself, in the order of the trace."""
    visits = [
        Visit(number, over, arc)
        for number, crossing in enumerate(crossings)
        for over, arc in ((True, crossing.arc_over), (False, crossing.arc_under))
    ]
    return sorted(visits, key=lambda visit: visit.arc)


@dataclass(frozen=True, slots=True, eq=False)
class _Search:
    """Looks for the shortest knotted pieces between visits of one strand."""

    strand: Strand
    visits: Sequence[Visit]

    def knotted_pieces(self) -> list[tuple[int, int]]:
        """Return the first and last visit of each knotted piece, in the order of the strand.

        A knot is complete where the strand up to there is knotted and stays so: a noose is
        knotted for a while, until the strand leaves it again. It begins in the same way, seen
        from there.
        """
        found, begin, last = [], 0, len(self.visits) - 1
        while begin < last and self.is_knotted(begin, last):
            ends = range(last - 1, begin, -1)
            end = 1 + next((k for k in ends if not self.is_knotted(begin, k)), begin)
            starts = range(begin + 1, end)
            first = next((k for k in starts if not self.is_knotted(k, end)), end) - 1
            found.append((first, end))
            begin = end + 1
        return found

    def is_knotted(self, first: int, last: int) -> bool:
        """Say whether the piece from one visit to another is knotted when closed over all."""
        part = piece(self.strand, self.visits[first].arc, self.visits[last].arc)
        return classify_diagram(close_over(part)).state is Knottedness.KNOTTED


def piece(strand: Strand, begin: float, end: float) -> Strand:
    """Return the part of a strand between two arc positions, a little beyond both."""
    arcs = arc_lengths(strand.points)
    low = max(begin * arcs[-1] - MARGIN_PX, 0.0)
    high = min(end * arcs[-1] + MARGIN_PX, arcs[-1])
    inside = (arcs > low) & (arcs < high)
    ends = point_at(strand.points, arcs, np.array([low, high]))
    points: Points = np.concatenate([ends[:1], strand.points[inside], ends[1:]])
    part_arcs, index = arc_lengths(points) + low, np.arange(len(arcs), dtype=float)
    part_index = np.arange(len(points), dtype=float)
    kept = []
    for crossing in strand.crossings:
        at_px = np.interp([crossing.first, crossing.second], index, arcs)
        if low <= at_px[0] and at_px[1] <= high:
            first, second = np.interp(at_px, part_arcs, part_index)
            kept.append(
                StrandCrossing(float(first), float(second), crossing.turn, crossing.first_over)
            )
    return Strand(points, tuple(kept))


def _entry_and_close(visits: Sequence[Visit], first: int, last: int) -> tuple[float, float]:
    """Return where a knotted piece is entered by an undercrossing, and that crossing's other visit.

    The thesis's rule asks that of the crossings that are left after cancelling, which may have
    lost the one that begins the knot to a strand that lies over it.
    """
    inside = visits[first : last + 1]
    for k, entry in enumerate(inside):
        for close in inside[k + 1 :]:
            if not entry.over and close.crossing == entry.crossing:
                return entry.arc, close.arc
    return visits[first].arc, visits[last].arc
