"""What is true about simulated cables; for scoring alone, no skill and no tree may read it."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from perception.cable.linking import classify_cables
from perception.cable.polyline import arc_lengths
from perception.cable.topology import (
    Knottedness,
    StrandCrossing,
    classify_curve,
    curve_crossings,
)
from perception.cable.topology.links import Linkedness
from perception.cable.types import Crossing, Trace, TraceEnd

Floats = NDArray[np.float64]

# Lines are handed to perception's knot theory as if seen from above, a millimetre a pixel.
_VIEW = np.array([1e3, -1e3])
# A piece that joins two cables rises within this share of its length to where nothing else is.
_RAMP, _OVER_ALL_M = 1e-4, 10.0


@dataclass(frozen=True, slots=True)
class CableTruth:
    """How cables ended.

    Attributes:
        untangled: Whether each is proved to be unknotted when its ends are joined over
            everything, and any two of them, too, whether each is closed by itself or both are
            joined to a ring.
        crossings: How often they cross themselves and each other, seen from above.
    """

    untangled: bool
    crossings: int


def cable_truth(*lines_m: Floats) -> CableTruth:
    """Score centre lines, one for each cable, shape (N, 3), world frame [m]."""
    verdicts = [classify_curve(line_m) for line_m in lines_m]
    unknots = all(verdict.state is Knottedness.UNKNOT for verdict in verdicts)
    free = unknots and all(_come_apart(one, other) for one, other in combinations(lines_m, 2))
    return CableTruth(free, len(crossings_of(lines_m)))


def _come_apart(one_m: Floats, other_m: Floats) -> bool:
    """Return whether two unknotted cables are proved not to be tied together."""
    return linkedness(one_m, other_m) is Linkedness.UNLINKED and any(
        classify_curve(ring).state is Knottedness.UNKNOT for ring in rings_of(one_m, other_m)
    )


def rings_of(one_m: Floats, other_m: Floats) -> tuple[Floats, ...]:
    """Return two cables as one, joined over everything, in all four ways.

    A square knot's cables are not linked when each is closed by itself; what ties them shows as
    a knot of the ring that they make together. Which ends meet, and which of both joints lies
    over the other, is open: cables that come apart make an unknotted ring in one of the ways.
    """
    ways = (one_m, other_m), (other_m, one_m), (one_m, other_m[::-1]), (other_m[::-1], one_m)
    return tuple(_joined(*way) for way in ways)


def _joined(first_m: Floats, then_m: Floats) -> Floats:
    """Return one line along both; the piece between them passes over everything."""
    ends_m = np.array([first_m[-1], then_m[0]])
    along = (ends_m[1] - ends_m[0]) * _RAMP
    raised_m = np.array([ends_m[0] + along, ends_m[1] - along])
    raised_m[:, 2] = _OVER_ALL_M
    return np.vstack([first_m, raised_m, then_m])


def centre_line_crossings(nodes_m: Floats) -> tuple[StrandCrossing, ...]:
    """Return where a centre line crosses itself from above, over and under by height."""
    return curve_crossings(np.asarray(nodes_m)).crossings


def crossings_of(lines_m: Sequence[Floats]) -> tuple[StrandCrossing, ...]:
    """Return where cables cross themselves and each other; nodes are numbered through."""
    joints = np.cumsum([len(line_m) for line_m in lines_m])[:-1] - 1
    found = centre_line_crossings(np.vstack(lines_m))
    return tuple(c for c in found if not {int(c.first), int(c.second)} & {*joints.tolist()})


def linkedness(one_m: Floats, other_m: Floats) -> Linkedness:
    """Say whether two cables are tied together, as far as it can be proved."""
    lines_m = (one_m, other_m)
    traces = [Trace(line_m[:, :2] * _VIEW, TraceEnd.ENDPOINT, 1.0) for line_m in lines_m]
    arcs = [arc_lengths(trace.points_px) for trace in traces]

    def place(arc: float) -> tuple[int, float]:
        which = int(arc >= len(one_m))
        along = np.interp(arc - which * len(one_m), np.arange(len(arcs[which])), arcs[which])
        return which, float(along / arcs[which][-1])

    crossings = []
    for crossing in crossings_of(lines_m):
        visits = (place(crossing.first), place(crossing.second))
        over, under = visits if crossing.first_over else visits[::-1]
        crossings.append(Crossing(np.zeros(2), *over, *under, probability=1.0))
    return classify_cables(traces, crossings).state
