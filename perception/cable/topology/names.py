"""Which knot it is: names of small knots and of their sums.

A diagram that falls into parts, each joined to the rest by one strand, is a sum, and each part
has its own name. A part with up to 8 crossings is named by its Alexander and Jones polynomials,
which are different for all knots with up to 8 crossings, sums among them (a test adds them up).
The unknot is told by them up to 24 crossings, see `verdict`.
A knot that differs from its mirror image is right-handed when the powers of its Jones polynomial
lie on the positive side, as those of the right-handed trefoil do.
"""

from collections.abc import Iterator
from functools import cache, lru_cache
from itertools import combinations_with_replacement

from perception.cable.topology.alexander import alexander_polynomial
from perception.cable.topology.braids import BRAIDS, closed_braid
from perception.cable.topology.diagram import Diagram, compact
from perception.cable.topology.jones import jones_polynomial
from perception.cable.topology.polynomial import ONE, Laurent
from perception.cable.topology.simplify import cancel, is_alternating, shorten, simplify
from perception.cable.topology.verdict import JONES_DECIDES_CROSSINGS

UNKNOT = "0_1"
# A knot that has no name here, or whose diagram does not get small enough to be told.
OTHER = "other"
# Nothing is known: the diagram cannot be drawn, or the cable was not seen.
UNKNOWN = "unknown"
MOST_CROSSINGS = 8
# Diagrams of equal size that are looked at where polynomials are those of a smaller knot.
STATES = 12

# Alexander and Jones polynomials.
Invariants = tuple[Laurent, Laurent]


def knot_type(diagram: Diagram) -> str:
    """Return the name of the knot of a closed diagram, e.g. `3_1 left # 4_1`."""
    if not diagram.is_planar():
        return UNKNOWN
    # Polynomials tell a small knot faster than moves undo it, except for the simplest moves.
    reduced = cancel(diagram)
    if len(reduced) > MOST_CROSSINGS:
        reduced = shorten(reduced)
    names = sorted(name for part in summands(reduced) if (name := _name(part)) != UNKNOT)
    for unsure in (UNKNOWN, OTHER):
        if unsure in names:
            return unsure
    return " # ".join(names) or UNKNOT


def summands(diagram: Diagram) -> Iterator[Diagram]:
    """Yield the parts of a diagram that one strand leads into and out of."""
    part = _inner_part(diagram)
    if part is None:
        yield diagram
        return
    start, stop = part
    sign_of, count = dict(enumerate(diagram.signs)), len(diagram.visits)
    inside = [place % count for place in range(start, stop)]
    outside = [place % count for place in range(stop, start + count)]
    for places in (inside, outside):
        visits = [diagram.visits[place] for place in places]
        yield from summands(compact(visits, [diagram.over[place] for place in places], sign_of))


def _inner_part(diagram: Diagram) -> tuple[int, int] | None:
    """Return from where to where the curve meets only crossings that it meets twice there."""
    count = len(diagram.visits)
    for start in range(count):
        met: set[int] = set()
        for place in range(start, start + count - 2):
            met ^= {diagram.visits[place % count]}
            if not met:
                return start, place + 1
    return None


@lru_cache(maxsize=4096)
def _name(part: Diagram) -> str:
    if len(part) > MOST_CROSSINGS and is_alternating(part):
        return OTHER
    found = _names().get(_invariants(part), OTHER)
    if len(part) <= MOST_CROSSINGS:
        return found
    if found == UNKNOT:
        return UNKNOT if len(part) <= JONES_DECIDES_CROSSINGS else UNKNOWN
    # A larger knot may have the same polynomials, as 10_132 and 5_1 do.
    small = found != OTHER and len(simplify(part, STATES)) <= MOST_CROSSINGS
    return found if small else OTHER


def _alexander(diagram: Diagram) -> Laurent:
    return Laurent(0, alexander_polynomial(diagram))


def _invariants(diagram: Diagram) -> Invariants:
    return _alexander(diagram), jones_polynomial(diagram)


@cache
def _names() -> dict[Invariants, str]:
    """Return the name to each pair of polynomials of a knot with up to 8 crossings."""
    primes: dict[str, Invariants] = {}
    for name, braid in BRAIDS.items():
        alexander, jones = _invariants(closed_braid(braid))
        for side in {jones, jones.inverted()}:
            primes[name + _hand(side)] = (alexander, side)
    names = {invariants: name for name, invariants in primes.items()}
    for one, other in combinations_with_replacement(sorted(primes), 2):
        if _crossings(one) + _crossings(other) <= MOST_CROSSINGS:
            (a, v), (b, w) = primes[one], primes[other]
            names[a * b, v * w] = f"{one} # {other}"
    return {(ONE, ONE): UNKNOT, **names}


def _hand(jones: Laurent) -> str:
    if jones == jones.inverted():
        return ""
    return " right" if jones.lowest + jones.highest > 0 else " left"


def _crossings(name: str) -> int:
    return int(name.split("_")[0])
