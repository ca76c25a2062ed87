"""Laurent polynomials with whole coefficients, and how one large number holds all of them."""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True, order=True)
class Laurent:
    """A polynomial with negative powers, too.

    Attributes:
        lowest: Power of the first coefficient; 0 for the zero polynomial.
        coefficients: From the lowest power up; neither the first nor the last is 0.
    """

    lowest: int
    coefficients: tuple[int, ...]

    @property
    def highest(self) -> int:
        """Power of the last coefficient."""
        return self.lowest + len(self.coefficients) - 1

    def inverted(self) -> "Laurent":
        """Return the polynomial with the variable's inverse put in."""
        return Laurent(-self.highest, self.coefficients[::-1])

    def __mul__(self, other: "Laurent") -> "Laurent":
        """Return the product."""
        product = [0] * (len(self.coefficients) + len(other.coefficients))
        for i, a in enumerate(self.coefficients):
            for j, b in enumerate(other.coefficients):
                product[i + j] += a * b
        return laurent(self.lowest + other.lowest, product)


ONE = Laurent(0, (1,))


def laurent(lowest: int, coefficients: Sequence[int]) -> Laurent:
    """Return the polynomial with these coefficients, zeros at both ends allowed."""
    filled = [place for place, value in enumerate(coefficients) if value]
    if not filled:
        return Laurent(0, ())
    return Laurent(lowest + filled[0], tuple(coefficients[filled[0] : filled[-1] + 1]))


def signed_digits(value: int, bits: int) -> list[int]:
    """Return the coefficients of a polynomial from its value at `2**bits`, the constant first.

    Every coefficient must be smaller than half of that (Kronecker substitution).
    """
    digits = []
    while value:
        digit = value & ((1 << bits) - 1)
        digit -= (digit >> (bits - 1)) << bits
        digits.append(digit)
        value = (value - digit) >> bits
    return digits
