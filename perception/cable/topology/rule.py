"""The thesis's knot rule (section 3.3): cancel crossings, then look for under ... over.

The rule is necessary for a knot but not sufficient, so it names places, and the diagram of
each place is classified afterwards (`perception.cable.knots`).
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
    """Return the first and last visit of each potential knot, in the order of the curve.

    A potential knot starts with an undercrossing whose other visit comes later, with at least
    one overcrossing in between that is not paired up inside.
    """
    left, found, begin = cancel(visits), [], 0
    while begin < len(left):
        end = _closing(left, begin)
        if end is None:
            begin += 1
        else:
            found.append((left[begin], left[end]))
            begin = end + 1
    return found


def _closing(visits: list[Visit], begin: int) -> int | None:
    """Return where the potential knot that starts at `begin` ends; None where none does."""
    if visits[begin].over:
        return None
    for end in range(begin + 1, len(visits)):
        if visits[end].crossing == visits[begin].crossing:
            inside = visits[begin + 1 : end]
            return end if any(visit.over for visit in inside) else None
    return None
