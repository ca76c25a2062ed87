"""The Jones polynomial from Kauffman's bracket.

Every crossing is opened in two ways, A and B; what is left is a set of loops. With d = -A^2 - A^-2
the bracket is the sum over all ways of A^(#A - #B) d^(loops - 1), and the Jones polynomial is
(-A^3)^-writhe times it at t = A^-4 (L. Kauffman, "State models and the Jones polynomial", 1987).

The sum is done crossing by crossing: of all that was opened so far only matters which open ends
are joined, and in the plane there are few ways, so ways that join alike are added at once.
"""

from collections import defaultdict
from collections.abc import Sequence
from typing import NamedTuple

from perception.cable.topology.diagram import Diagram
from perception.cable.topology.polynomial import ONE, Laurent, laurent, signed_digits


class Ends(NamedTuple):
    """The four edges at a crossing, and its sign."""

    over_in: int
    over_out: int
    under_in: int
    under_out: int
    sign: int

    def openings(self) -> tuple[tuple[tuple[int, int], tuple[int, int]], ...]:
        """Return which edges opening A joins, then opening B.

        A joins the regions that the upper strand sweeps when it turns counter-clockwise.
        """
        along = ((self.over_in, self.under_out), (self.under_in, self.over_out))
        across = ((self.over_in, self.under_in), (self.over_out, self.under_out))
        return (along, across) if self.sign > 0 else (across, along)


def jones_polynomial(diagram: Diagram) -> Laurent:
    """Return the Jones polynomial in t.

    The unknot has 1, the right-handed trefoil t + t^3 - t^4.
    """
    in_a = writhe_free_bracket(ends_of(diagram))
    powers = range(-in_a.highest, -in_a.lowest + 1, 4)
    return laurent(powers[0] // 4, [in_a.coefficients[-in_a.lowest - power] for power in powers])


def ends_of(diagram: Diagram) -> list[Ends]:
    """Return the crossings of a closed curve with its edges numbered by the visits they leave."""
    count, other = len(diagram.visits), diagram.partners()
    return [
        Ends((k - 1) % count, k, (other[k] - 1) % count, other[k], diagram.signs[crossing])
        for k, (crossing, on_top) in enumerate(zip(diagram.visits, diagram.over, strict=True))
        if on_top
    ]


def writhe_free_bracket(crossings: Sequence[Ends]) -> Laurent:
    """Return the bracket times (-A^3)^-writhe, in A, of one curve or several that cross."""
    if not crossings:
        return ONE
    writhe, count = sum(ends.sign for ends in crossings), len(crossings)
    # With X = A^2: openings weigh X and 1, joints X, loops -(X^2 + 1), which adds powers of A
    # that are the same for all ways and come off below.
    bits = 2 * count + 4
    total = _sum_over_openings(_in_reading_order(crossings), bits)
    digits = signed_digits(total // -((1 << 2 * bits) + 1), bits)
    in_a = [0] * (2 * len(digits))
    in_a[::2] = [-value if writhe % 2 else value for value in digits]
    return laurent(2 - 5 * count - 3 * writhe, in_a)


def _in_reading_order(crossings: Sequence[Ends]) -> list[Ends]:
    """Return the crossings such that few edges are open at a time."""
    left, ordered, met = list(crossings), list[Ends](), set[int]()
    while left:
        best = max(left, key=lambda ends: sum(edge in met for edge in ends[:4]))
        left.remove(best)
        ordered.append(best)
        met ^= {edge for edge in best[:4] if best[:4].count(edge) == 1}
    return ordered


# Which open edge is joined to which, both ways round, in the order of the edges.
Joined = tuple[tuple[int, int], ...]


def _sum_over_openings(crossings: Sequence[Ends], bits: int) -> int:
    sums: dict[Joined, int] = {(): 1}
    for ends in crossings:
        following: defaultdict[Joined, int] = defaultdict(int)
        for joined, value in sums.items():
            for pairs, weighed in zip(ends.openings(), (value << bits, value), strict=True):
                open_ends = dict(joined)
                for a, b in pairs:
                    if _join(open_ends, a, b):
                        weighed = -(weighed << 2 * bits) - weighed
                    else:
                        weighed <<= bits
                following[tuple(sorted(open_ends.items()))] += weighed
        sums = following
    return sums[()]


def _join(open_ends: dict[int, int], a: int, b: int) -> bool:
    """Join an end of two edges; say whether that closes a loop."""
    if a == b:
        return True
    far_a = open_ends.pop(a, a)
    if far_a == b:
        del open_ends[b]
        return True
    far_b = open_ends.pop(b, b)
    open_ends[far_a], open_ends[far_b] = far_b, far_a
    return False
