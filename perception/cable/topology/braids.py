"""Knots by name: braids whose closures are the prime knots with up to 8 crossings.

Names are those of D. Rolfsen, "Knots and Links" (1976); braids as in V. Jones, "Hecke algebra
representations of braid groups and link polynomials" (1987), and in KnotInfo (C. Livingston and
A. Moore). A letter k lets strand k pass to the right over strand k + 1, -k to the right under it.
Of a knot and its mirror image the table has one; which one does not matter.
"""

from collections.abc import Sequence

from perception.cable.topology.diagram import Diagram, compact

BRAIDS: dict[str, tuple[int, ...]] = {
    "3_1": (1, 1, 1),
    "4_1": (1, -2, 1, -2),
    "5_1": (1, 1, 1, 1, 1),
    "5_2": (1, 1, 1, 2, -1, 2),
    "6_1": (1, 1, 2, -1, -3, 2, -3),
    "6_2": (1, 1, 1, -2, 1, -2),
    "6_3": (1, 1, -2, 1, -2, -2),
    "7_1": (1, 1, 1, 1, 1, 1, 1),
    "7_2": (1, 1, 1, 2, -1, 2, 3, -2, 3),
    "7_3": (1, 1, 1, 1, 1, 2, -1, 2),
    "7_4": (1, 1, 2, -1, 2, 2, 3, -2, 3),
    "7_5": (1, 1, 1, 1, 2, -1, 2, 2),
    "7_6": (1, 1, -2, 1, 3, -2, 3),
    "7_7": (1, -2, 1, -2, 3, -2, 3),
    "8_1": (1, 1, 2, -1, 2, 3, -2, -4, 3, -4),
    "8_2": (1, 1, 1, 1, 1, -2, 1, -2),
    "8_3": (1, 1, 2, -1, -3, 2, -3, -4, 3, -4),
    "8_4": (1, 1, 1, -2, 1, -2, -3, 2, -3),
    "8_5": (1, 1, 1, -2, 1, 1, 1, -2),
    "8_6": (1, 1, 1, 1, 2, -1, -3, 2, -3),
    "8_7": (1, 1, 1, 1, -2, 1, -2, -2),
    "8_8": (1, 1, 1, 2, -1, -3, 2, -3, -3),
    "8_9": (1, 1, 1, -2, 1, -2, -2, -2),
    "8_10": (1, 1, 1, -2, 1, 1, -2, -2),
    "8_11": (1, 1, 2, -1, 2, 2, -3, 2, -3),
    "8_12": (1, -2, 1, 3, -2, -4, 3, -4),
    "8_13": (1, 1, -2, 1, -2, -2, -3, 2, -3),
    "8_14": (1, 1, 1, 2, -1, 2, -3, 2, -3),
    "8_15": (1, 1, -2, 1, 3, 2, 2, 2, 3),
    "8_16": (1, 1, -2, 1, 1, -2, 1, -2),
    "8_17": (1, 1, -2, 1, -2, 1, -2, -2),
    "8_18": (1, -2, 1, -2, 1, -2, 1, -2),
    "8_19": (1, 1, 1, 2, 1, 1, 1, 2),
    "8_20": (1, 1, 1, -2, -1, -1, -1, -2),
    "8_21": (1, 1, 1, 2, -1, -1, 2, 2),
}


def closed_braid(letters: Sequence[int]) -> Diagram:
    """Return the diagram of a braid whose strands are joined to one closed curve."""
    visits, over, at = list[int](), list[bool](), 1
    while not visits or at != 1:
        for number, letter in enumerate(letters):
            left = abs(letter)
            if at in (left, left + 1):
                visits.append(number)
                over.append((at == left) == (letter > 0))
                at = left + 1 if at == left else left
    return compact(visits, over, {k: 1 if c > 0 else -1 for k, c in enumerate(letters)})
