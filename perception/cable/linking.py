"""Are two traced cables linked, once the ends of each are joined?

What open cables do to each other depends on how they are closed. Here the ends of one are joined
below everything and those of the other over everything, so that a cable that only lies on another
comes off. Cables are unlinked where one of both choices lets them come apart, and linked where
neither does.
"""

from collections.abc import Sequence

import numpy as np

from perception.cable.crossings import strand_of
from perception.cable.polyline import arc_lengths, point_at
from perception.cable.topology.curve import Floats, intersections
from perception.cable.topology.links import Link, Linkedness, LinkVerdict, classify_link
from perception.cable.types import Crossing, Points, Trace

# Position along a curve that is closed (in segments), crossing, whether it is on top.
Passage = tuple[float, int, bool]
Y_UP = np.array([1.0, -1.0])
TANGENT_PX = 5.0


def classify_cables(
    traces: Sequence[Trace], crossings: Sequence[Crossing], pair: tuple[int, int] = (0, 1)
) -> LinkVerdict:
    """Say whether two cables are linked.

    Args:
        traces: Traces of all cables.
        crossings: Crossings of all traces.
        pair: Indices of the two.

    Returns:
        The verdict that frees them, else the one that leaves open whether they are linked.
    """
    choices = [classify_link(link_of(traces, crossings, way)) for way in (pair, pair[::-1])]
    for state in (Linkedness.UNLINKED, Linkedness.UNDECIDED):
        for verdict in choices:
            if verdict.state is state:
                return verdict
    return choices[0]


def link_of(
    traces: Sequence[Trace], crossings: Sequence[Crossing], pair: tuple[int, int] = (0, 1)
) -> Link:
    """Return two traces with their crossings as closed curves.

    Args:
        traces: Traces of all cables.
        crossings: Crossings of all traces.
        pair: Indices of the two; the first is closed below everything, the second over it.
    """
    lines = [traces[index].points_px * Y_UP for index in pair]
    passages: tuple[list[Passage], list[Passage]] = ([], [])
    signs: list[int] = []
    for which, index in enumerate(pair):
        for c in strand_of(traces[index], index, crossings).crossings:
            passages[which].append((c.first, len(signs), c.first_over))
            passages[which].append((c.second, len(signs), not c.first_over))
            signs.append(c.turn if c.first_over else -c.turn)
    for crossing in crossings:
        if {crossing.trace_over, crossing.trace_under} == set(pair):
            over, under = pair.index(crossing.trace_over), pair.index(crossing.trace_under)
            at_over, along_over = _place(lines[over], crossing.arc_over)
            at_under, along_under = _place(lines[under], crossing.arc_under)
            passages[over].append((at_over, len(signs), True))
            passages[under].append((at_under, len(signs), False))
            signs.append(_turn(along_over, along_under))
    _close(lines, passages, signs)
    first, second = (
        tuple((number, on_top) for _, number, on_top in sorted(passed)) for passed in passages
    )
    return Link((first, second), tuple(signs))


def _place(line: Points, arc: float) -> tuple[float, Points]:
    """Return a position in segments, and the way the line runs there."""
    arcs = arc_lengths(line)
    at_px = arc * arcs[-1]
    chord = np.diff(point_at(line, arcs, at_px + np.array([-TANGENT_PX, TANGENT_PX])), axis=0)[0]
    return float(np.interp(at_px, arcs, np.arange(len(arcs), dtype=float))), chord


def _turn(a: Points, b: Points) -> int:
    return 1 if a[0] * b[1] - a[1] * b[0] > 0.0 else -1


def _close(lines: list[Floats], passages: tuple[list[Passage], ...], signs: list[int]) -> None:
    """Join the ends of the first line by a straight piece below all, of the second over all."""
    chords = [line[[-1, 0]] for line in lines]
    lasts = [len(line) - 1 for line in lines]
    for which, on_top in ((0, False), (1, True)):
        met = [(other, lines[other], 0.0) for other in (0, 1)]
        met += [(0, chords[0], lasts[0] + 1.0)] if on_top else []
        for other, line, offset in met:
            on_chord, on_line, turn = intersections(chords[which], line)
            for s, position, t in zip(on_chord, on_line, turn, strict=True):
                if other == which and not 1.0 <= position <= lasts[other] - 1.0:
                    continue  # A piece that closes a line meets it at its ends.
                passages[which].append((lasts[which] + 1.0 + float(s), len(signs), on_top))
                passages[other].append((offset + float(position), len(signs), not on_top))
                signs.append(int(t) if on_top else -int(t))
