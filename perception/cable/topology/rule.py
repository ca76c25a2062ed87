"""The thesis's knot rule (section 3.3): cancel crossings, then look for under ... over.

The rule is necessary for a knot but not sufficient: `perception.cable.knots` asks it only
about pieces that are proved to be knotted, and benchmarks hold it against the proof.
"""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Visit:
    """One pass of an open curve through a crossing.

    Attributes:
        crossing: Number of the crossing.
        over: Whether the curve is on top.
        arc: Where on the curve.
    """

    crossing: int
    over: bool
    arc: float


def cancel(visits: Sequence[Visit]) -> list[Visit]:
    """Return the visits that are left after Reidemeister moves I and II, made to an end."""
    left = list(visits)
    while (fewer := _cancel_first(left)) is not None:
        left = fewer
    return left


def _cancel_first(visits: list[Visit]) -> list[Visit] | None:
    """Return the visits after the first move; None where none is left."""
    neighbours: dict[frozenset[int], int] = {}
    for k in range(len(visits) - 1):
        a, b = visits[k], visits[k + 1]
        if a.crossing == b.crossing:
            return visits[:k] + visits[k + 2 :]
        pair = frozenset((a.crossing, b.crossing))
        j = neighbours.setdefault(pair, k)
        if j < k - 1 and a.over == b.over:
            return visits[:j] + visits[j + 2 : k] + visits[k + 2 :]
    return None


def knot_intervals(visits: Sequence[Visit]) -> list[tuple[Visit, Visit]]:
    """Return the first and last visit of each potential knot, in the order of the curve."""
    return uncancelled_intervals(cancel(visits))


def uncancelled_intervals(visits: Sequence[Visit]) -> list[tuple[Visit, Visit]]:
    """Return what `knot_intervals` returns of visits that are taken as they are."""
    found, begin = [], 0
    while begin < len(visits):
        close = closing_visit(visits, begin)
        if close is None:
            begin += 1
        else:
            found.append((visits[begin], close))
            begin = visits.index(close) + 1
    return found


def closing_visit(visits: Sequence[Visit], begin: int) -> Visit | None:
    """Return the visit that closes the potential knot which begins at a visit.

    A potential knot starts with an undercrossing whose other visit comes later, with at least
    one overcrossing in between.

    Args:
        visits: Visits of the curve that are left after cancelling.
        begin: Index of the visit that may begin a knot.

    Returns:
        The overcrossing at the same place, or None where no knot begins.
    """
    if visits[begin].over:
        return None
    for end in range(begin + 1, len(visits)):
        if visits[end].crossing == visits[begin].crossing:
            inside = visits[begin + 1 : end]
            return visits[end] if any(visit.over for visit in inside) else None
    return None
