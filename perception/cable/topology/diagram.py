"""A knot diagram as a signed Gauss code, and the faces it cuts the sphere into.

Follow the closed curve and write down each crossing as it is passed: its number and whether
the strand is on top. With the sign of every crossing this fixes the diagram on the sphere.
A crossing is positive when the upper strand turns counter-clockwise (y up) onto the lower.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

# The next edge of the face on the left of an edge that is walked forwards or backwards.
TurnLeft = Callable[[int, bool], tuple[int, bool]]


@dataclass(frozen=True, slots=True)
class Diagram:
    """A closed curve with n crossings.

    Attributes:
        visits: Number of the crossing at each of the 2n visits, in the order of the curve.
        over: Whether the strand is on top at that visit; each crossing once each way.
        signs: +1 or -1 for each crossing.
    """

    visits: tuple[int, ...]
    over: tuple[bool, ...]
    signs: tuple[int, ...]

    def __len__(self) -> int:
        """Return the number of crossings."""
        return len(self.signs)

    def partners(self) -> list[int]:
        """Return for each visit the place of the other visit of the same crossing."""
        return partners_of(self.visits)

    def faces(self) -> tuple[list[int], list[int], int]:
        """Return the face to the left and to the right of each edge, and how many there are.

        Edge e runs from visit e to visit e + 1 (cyclic).
        """
        other = self.partners()
        return walked_faces(len(self.visits), partial(self._turn_left, other))

    def _turn_left(self, other: list[int], edge: int, forward: bool) -> tuple[int, bool]:
        """Return the next edge of the face on the left, and the way it is walked."""
        count = len(self.visits)
        place = (edge + 1) % count if forward else edge
        goes_on = (forward == self.over[place]) == (self.signs[self.visits[place]] > 0)
        return (other[place], True) if goes_on else ((other[place] - 1) % count, False)

    def is_planar(self) -> bool:
        """Say whether it can be drawn on the sphere: Euler's formula F = n + 2."""
        return not self.visits or self.faces()[2] == len(self) + 2

    def swapped(self, crossings: frozenset[int]) -> "Diagram":
        """Return the diagram with over and under exchanged at `crossings`."""
        over = tuple(
            on_top != (crossing in crossings)
            for crossing, on_top in zip(self.visits, self.over, strict=True)
        )
        signs = tuple(-s if c in crossings else s for c, s in enumerate(self.signs))
        return Diagram(self.visits, over, signs)

    def cyclic_name(self) -> tuple[int, ...]:
        """Return what does not depend on where the curve starts and how crossings are numbered.

        Each visit is told by how far on the other visit of its crossing is, which is on top and
        the sign; of all ways to turn this round, the smallest is taken.
        """
        count, signs = len(self.visits), self.signs
        code = [
            ((other - place) % count * 2 + on_top) * 2 + (signs[crossing] > 0)
            for place, (other, crossing, on_top) in enumerate(
                zip(self.partners(), self.visits, self.over, strict=True)
            )
        ]
        least, twice = min(code, default=0), tuple(code * 2)
        starts = [place for place in range(count) if code[place] == least]
        return min((twice[place : place + count] for place in starts), default=())

    def mirrored(self) -> "Diagram":
        """Return the mirror image: over and under exchanged everywhere."""
        return self.swapped(frozenset(range(len(self))))


def compact(visits: list[int], over: list[bool], sign_of: dict[int, int]) -> Diagram:
    """Return the diagram of these visits with crossings numbered as they are met first."""
    numbers: dict[int, int] = {}
    for crossing in visits:
        numbers.setdefault(crossing, len(numbers))
    signs = tuple(sign_of[crossing] for crossing in numbers)
    return Diagram(tuple(numbers[crossing] for crossing in visits), tuple(over), signs)


def partners_of(visits: Sequence[int]) -> list[int]:
    """Return for each visit the place of the other visit of the same crossing."""
    first: dict[int, int] = {}
    other = [0] * len(visits)
    for place, crossing in enumerate(visits):
        if crossing in first:
            other[place], other[first[crossing]] = first[crossing], place
        else:
            first[crossing] = place
    return other


def walked_faces(edges: int, turn_left: TurnLeft) -> tuple[list[int], list[int], int]:
    """Return the face to the left and to the right of each edge, and how many there are.

    Args:
        edges: How many edges there are.
        turn_left: Tells where the walk round a face goes on.
    """
    sides = [[-1] * edges, [-1] * edges]  # of edges walked backwards, forwards
    faces = 0
    for start in range(2 * edges):
        edge, forward = start >> 1, bool(start & 1)
        if sides[forward][edge] >= 0:
            continue
        while sides[forward][edge] < 0:
            sides[forward][edge] = faces
            edge, forward = turn_left(edge, forward)
        faces += 1
    return sides[1], sides[0], faces
