"""Where the first knot of a cable begins, from its line in space alone.

Asked is first the piece of the cable in which the knot was tied, by two definitions. By
topology: the shortest first part that is knotted when closed over everything, and of this the
shortest last part that still is; it begins with an undercrossing, as what begins on top can be
taken off. By the thesis's rule (section 3.3): crossings are cancelled, then under ... over is
looked for. Where they differ, which few knots allow, either is right.

Who sees the cable does not know in which piece somebody has tied. Where the rest of the cable
lies on the knot, the same knot may be made with its crossings instead. So the whole cable is
asked, too: which first part is knotted and stays so, however much more of the cable is added,
and from where on, likewise. In one of a hundred scenes this names another crossing, and is
right as well.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from perception.cable.topology import (
    Knottedness,
    Strand,
    StrandCrossing,
    classify_diagram,
    close_over,
    curve_crossings,
)
from perception.cable.topology.alexander import alexander_polynomial
from perception.cable.topology.rule import Visit, knot_intervals

Floats = NDArray[np.float64]


def first_undercrossings(nodes: Floats, tied: tuple[float, float]) -> Floats:
    """Return where the first knot begins, shape (K, 2); one row a definition, none without a knot.

    Args:
        nodes: Centre line from the traced end on, z up, shape (N, 3).
        tied: Between which nodes the knot was tied.
    """
    whole = curve_crossings(nodes)
    strand = part(whole, *tied)
    piece = first_piece(strand)
    if piece is None:
        return np.empty((0, 2))
    begins = [piece[0], *(begin.arc for begin, _ in knot_intervals(visits_of(strand))[:1])]
    return np.vstack([_places(strand, begins), _places(whole, lasting_begin(whole))])


def _places(strand: Strand, numbers: Sequence[float]) -> Floats:
    index = np.arange(len(strand.points), dtype=float)
    return np.column_stack([np.interp(numbers, index, axis) for axis in strand.points.T])


def lasting_begin(strand: Strand) -> list[float]:
    """Return where the first part begins that is knotted and stays so; empty without a knot.

    Places are node numbers. Parts are cut between visits of crossings.
    """
    visits = visits_of(strand)
    if not is_knotted(strand):
        return []
    arcs = [visit.arc for visit in visits]
    cuts = [0.0, *np.convolve(arcs, [0.5, 0.5], "valid"), len(strand.points) - 1.0]
    end = len(visits)
    while is_knotted(part(strand, 0.0, cuts[end - 1])):
        end -= 1
    begin = 0
    while is_knotted(part(strand, cuts[begin + 1], cuts[end])):
        begin += 1
    return [next(visit.arc for visit in visits[begin:] if not visit.over)]


def first_piece(strand: Strand) -> tuple[float, float] | None:
    """Return the first and last visit of the first knotted piece; None where there is none."""
    visits = [visit.arc for visit in visits_of(strand)]
    if not is_knotted(strand):
        return None
    cuts = [0.0, *np.convolve(visits, [0.5, 0.5], "valid"), len(strand.points) - 1.0]
    last = next(k for k in range(len(visits)) if is_knotted(part(strand, 0.0, cuts[k + 1])))
    pieces = (k for k in range(last, -1, -1) if is_knotted(part(strand, cuts[k], cuts[last + 1])))
    return visits[next(pieces)], visits[last]


def visits_of(strand: Strand) -> list[Visit]:
    """Return the visits of crossings in the order of a strand, arcs as node numbers."""
    visits = []
    for number, crossing in enumerate(strand.crossings):
        visits.append(Visit(number, crossing.first_over, crossing.first))
        visits.append(Visit(number, not crossing.first_over, crossing.second))
    return sorted(visits, key=lambda visit: visit.arc)


def is_knotted(strand: Strand) -> bool:
    """Say whether a strand is proved to be knotted."""
    return classify_diagram(close_over(strand)).state is Knottedness.KNOTTED


def is_unknotted(strand: Strand) -> bool:
    """Say whether a strand is proved not to be knotted."""
    return classify_diagram(close_over(strand)).state is Knottedness.UNKNOT


def polynomial(strand: Strand) -> tuple[int, ...]:
    """Return the Alexander polynomial of a strand."""
    return alexander_polynomial(close_over(strand))


def part(strand: Strand, low: float, high: float) -> Strand:
    """Return the part of a strand between two places, as node numbers with fractions."""
    index = np.arange(len(strand.points), dtype=float)
    places = np.concatenate([[low], index[(index > low) & (index < high)], [high]])
    points = np.column_stack([np.interp(places, index, axis) for axis in strand.points.T])
    numbers = np.arange(len(places), dtype=float)
    kept = []
    for crossing in strand.crossings:
        if low <= crossing.first and crossing.second <= high:
            first, second = np.interp([crossing.first, crossing.second], places, numbers)
            kept.append(
                StrandCrossing(float(first), float(second), crossing.turn, crossing.first_over)
            )
    return Strand(points, tuple(kept))
