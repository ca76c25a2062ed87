"""The Alexander polynomial: what proves that a diagram cannot be undone.

Matrix of the Wirtinger arcs (Fox calculus): at a crossing with over-arc o and under-arcs
a before, b after, the row is (1 - t) o + t a - b, with a and b exchanged for a negative
crossing. Any minor of it is the polynomial up to a factor +-t^k (J. W. Alexander,
"Topological invariants of knots and links", 1928).
"""

from perception.cable.topology.diagram import Diagram
from perception.cable.topology.polynomial import signed_digits


def alexander_polynomial(diagram: Diagram) -> tuple[int, ...]:
    """Return the coefficients from the constant term up, the first one positive.

    The unknot has (1,), the trefoil (1, -1, 1), the figure-8 knot (1, -3, 1).
    """
    size = len(diagram)
    # Rows hold at most four units, so coefficients stay below 4^(n-1), and the value at
    # one large enough power of two has them all as its digits (Kronecker substitution).
    bits = 2 * size + 2
    digits = signed_digits(_minor(diagram, 1 << bits), bits)
    while digits and digits[0] == 0:
        digits.pop(0)
    sign = -1 if digits and digits[0] < 0 else 1
    return tuple(sign * digit for digit in digits)


def determinant(diagram: Diagram) -> int:
    """Return the absolute value of the polynomial at -1, which is 1 for the unknot."""
    return abs(_minor(diagram, -1))


def _minor(diagram: Diagram, t: int) -> int:
    """Return the Alexander matrix's minor without its last row and column, at `t`."""
    size, arc = len(diagram), 0
    rows = [[0] * size for _ in range(size)]
    for crossing, on_top in zip(diagram.visits, diagram.over, strict=True):
        row = rows[crossing]
        if on_top:
            row[arc] += 1 - t
            continue
        following = (arc + 1) % size
        before, after = (t, -1) if diagram.signs[crossing] > 0 else (-1, t)
        row[arc] += before
        row[following] += after
        arc = following
    return _determinant([row[:-1] for row in rows[:-1]])


def _determinant(rows: list[list[int]]) -> int:
    """Return the exact determinant by fraction-free elimination (Bareiss 1968)."""
    sign, previous = 1, 1
    for k in range(len(rows) - 1):
        pivot = next((i for i in range(k, len(rows)) if rows[i][k]), None)
        if pivot is None:
            return 0
        if pivot != k:
            rows[k], rows[pivot], sign = rows[pivot], rows[k], -sign
        top, head = rows[k], rows[k][k]
        for row in rows[k + 1 :]:
            factor = row[k]
            for j in range(k + 1, len(rows)):
                row[j] = (row[j] * head - factor * top[j]) // previous
        previous = head
    return sign * rows[-1][-1] if rows else 1
