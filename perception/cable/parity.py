"""Can the crossings of a trace be drawn at all?

A closed curve in the plane meets itself an even number of times between the two visits of each
of its crossings (C. F. Gauss), and its faces fit Euler's formula. Where that fails, a crossing
was missed or invented, and no knot can be told from the rest.
"""

from perception.cable.topology import Strand, close_over


def parity_violations(strand: Strand) -> tuple[int, ...]:
    """Return the crossings of a strand that have an odd number of visits between their own.

    Args:
        strand: An open curve with its crossings; it is closed by a straight piece. Who is on
            top does not matter.

    Returns:
        Numbers of the crossings.
    """
    visits = close_over(strand).visits
    odd = []
    for number in range(len(strand.crossings)):
        first = visits.index(number)
        if (visits.index(number, first + 1) - first) % 2 == 0:
            odd.append(number)
    return tuple(odd)


def can_be_drawn(strand: Strand) -> bool:
    """Say whether a strand's crossings are those of some curve in the plane."""
    return close_over(strand).is_planar()
