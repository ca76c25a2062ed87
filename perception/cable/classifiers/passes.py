"""One strand's way through a crossing, as classifiers look along it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from perception.cable.crossings import CrossingSite
from perception.cable.polyline import arc_lengths, point_at
from perception.cable.types import Points, Trace

# Beyond its ends a line goes on the way of its last points.
END_POINTS = 3


@dataclass(frozen=True, slots=True, eq=False)
class StrandPass:
    """A line and the place on it where it meets another one.

    Attributes:
        line: Points of the line near the meeting, or all of it, shape (N, 2), N >= 2.
        at: Arc length from the line's first point to the meeting.
    """

    line: Points
    at: float


def passes_of(site: CrossingSite, traces: Sequence[Trace]) -> tuple[StrandPass, StrandPass]:
    """Return both strands of a site."""
    first, second = (
        StrandPass(traces[trace].points_px, arc * float(arc_lengths(traces[trace].points_px)[-1]))
        for trace, arc in zip(site.traces, site.arcs, strict=True)
    )
    return first, second


def path_through(strand: StrandPass, reach: float, step: float) -> Points:
    """Return points every `step` from `reach` before the meeting to `reach` behind it.

    Beyond the ends of the line they go straight on.

    Args:
        strand: Line and place on it.
        reach: Length to either side, in units of the line.
        step: Distance of points; the middle one is the meeting.
    """
    arcs = arc_lengths(strand.line)
    count = round(reach / step)
    at = strand.at + step * np.linspace(-count, count, 2 * count + 1)
    path = point_at(strand.line, arcs, at)
    ahead = _outwards(strand.line)
    behind = _outwards(strand.line[::-1])
    path += np.maximum(at - arcs[-1], 0.0)[:, None] * ahead
    path += np.maximum(-at, 0.0)[:, None] * behind
    return path


def _outwards(line: Points) -> Points:
    """Return the unit vector in which a line leaves its last point."""
    chord = line[-1] - line[-min(END_POINTS, len(line))]
    unit: Points = chord / max(float(np.linalg.norm(chord)), 1e-9)
    return unit
