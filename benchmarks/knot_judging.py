"""Is what a system says about a knot right, and if not, what went wrong first?

As in the thesis (table 4.1): with a knot, the first knot must be found and its first
undercrossing be right, which people said there and `benchmarks.knot_truth` says here; without
one, none must be reported. Stricter than the thesis, a system may say that there is none only
where it has followed the cable to another end: who saw nothing does not know. Who is given the
true line and its true crossings is right in all scenes (216 of 216, from either end).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from benchmarks.knot_scenes import KnotScene
from perception.cable.following import followed_share
from perception.cable.polyline import arc_lengths, point_at
from perception.cable.topology import curve_crossings
from perception.cable.types import CableScene, Crossing, Knot, Trace, TraceEnd

Floats = NDArray[np.float64]

# Two centre lines that are each off by half a cable width cross this many widths away where
# they meet at 30 degrees and more; neighbouring crossings of a knot are farther apart.
PLACE_WIDTHS = 1.5
# A trace follows a line within so many cable widths; connectors hide the ends themselves.
ASIDE_WIDTHS, GAP_WIDTHS, END_WIDTHS = 1.3, 5.0, 5.0
# A crossing is the true one when both its visits are within so many widths along the cable.
ALONG_WIDTHS = 5.0


class Wrong(StrEnum):
    """How an answer differs from the truth; letters as in the thesis's table 4.1."""

    MISSED = "missed knot (A)"
    FALSE = "false knot (B)"
    PLACE = "knot begins elsewhere (E)"
    UNSEEN = "says no knot of a cable that it has not seen whole"


class Cause(StrEnum):
    """The first step that went wrong."""

    ENDS = "no trace"
    TRACING = "tracing"
    CROSSING = "crossing"
    DECIDING = "deciding"


@dataclass(frozen=True, slots=True)
class Failure:
    """A wrong answer and its cause."""

    wrong: Wrong
    cause: Cause


def judged(scene: KnotScene, seen: CableScene) -> Failure | None:
    """Return what is wrong with an answer; None where it is right.

    The first knot is looked for in the direction of the trace that it is on.
    """
    wrong = _wrong(scene, seen)
    if wrong is None:
        return None
    number = seen.knots[0].trace if seen.knots else 0
    return Failure(wrong, _cause(scene, seen, number))


def _wrong(scene: KnotScene, seen: CableScene) -> Wrong | None:
    if not scene.is_knotted:
        if seen.knots:
            return Wrong.FALSE
        whole = any(_comes_through(scene, trace) for trace in seen.traces)
        return None if whole else Wrong.UNSEEN
    if not seen.knots:
        return Wrong.MISSED
    first = seen.knots[0]
    return None if _is_place(scene, seen.traces[first.trace], first, seen) else Wrong.PLACE


def _comes_through(scene: KnotScene, trace: Trace) -> bool:
    """Say whether a trace leads from one end of the cable to the other, by whatever way."""
    ends_px = scene.nodes_from(trace.points_px[0])[[0, -1], :2]
    gaps_px = np.linalg.norm(trace.points_px[[0, -1]] - ends_px, axis=1)
    near = gaps_px < 2.0 * END_WIDTHS * scene.width_px
    return trace.end is TraceEnd.ENDPOINT and bool(near.all())


def _is_place(scene: KnotScene, trace: Trace, knot: Knot, seen: CableScene) -> bool:
    """Say whether a knot begins where the first knot of a cable does.

    A system that knows no crossings only says within which piece; it is right if that holds
    the true place.
    """
    truth_px = scene.undercrossings_from(trace.points_px[0])
    said_px = knot.first_undercrossing_px[None]
    if not seen.crossings:
        arcs = arc_lengths(trace.points_px)
        said_px = point_at(trace.points_px, arcs, np.linspace(*knot.interval, 200) * arcs[-1])
    gaps = np.linalg.norm(truth_px[:, None] - said_px[None], axis=2)
    return bool(gaps.min() < PLACE_WIDTHS * scene.width_px)


def _cause(scene: KnotScene, seen: CableScene, number: int) -> Cause:
    if not seen.traces:
        return Cause.ENDS
    trace = seen.traces[number]
    nodes = scene.nodes_from(trace.points_px[0])
    if not follows(nodes[:, :2], trace.points_px, scene.width_px):
        return Cause.TRACING
    own = [c for c in seen.crossings if c.trace_over == c.trace_under == number]
    agree = crossings_agree(nodes, own, ALONG_WIDTHS * scene.width_px)
    return Cause.DECIDING if agree else Cause.CROSSING


def follows(line_px: Floats, path_px: Floats, width_px: float) -> bool:
    """Say whether a path follows a whole line from one end to the other."""
    hidden = int(END_WIDTHS * width_px / np.linalg.norm(np.diff(line_px, axis=0), axis=1).mean())
    truth = line_px[hidden:-hidden]
    share = followed_share(truth, path_px, ASIDE_WIDTHS * width_px, GAP_WIDTHS * width_px)
    beyond = float(np.linalg.norm(path_px[-1] - line_px[-1]))
    return share >= 1.0 and beyond < 2.0 * END_WIDTHS * width_px


def crossings_agree(nodes: Floats, found: Sequence[Crossing], within_px: float) -> bool:
    """Say whether crossings are the true ones, over and under right.

    Args:
        nodes: True line in the direction of the trace, shape (N, 3).
        found: Crossings of the trace with itself.
        within_px: How far along the cable either visit may be off.
    """
    arcs, index = arc_lengths(nodes[:, :2]), np.arange(len(nodes), dtype=float)
    true = [
        np.interp((c.first, c.second) if c.first_over else (c.second, c.first), index, arcs)
        for c in curve_crossings(nodes).crossings
    ]
    said = [np.array([c.arc_over, c.arc_under]) * arcs[-1] for c in found]
    if len(true) != len(said):
        return False
    return all(any(np.abs(a - b).max() < within_px for b in said) for a in true)
