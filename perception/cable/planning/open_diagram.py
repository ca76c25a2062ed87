"""A cable that lies on a table, as a diagram with two ends.

The signed code of `topology.diagram`, but of a curve that is not closed. What is proved about
knots is proved about closed curves; a robot moves open ones, where it matters in which face an
end lies. Arc positions ride along, so that every visit can be found on the cable again; two
diagrams are equal when their codes are, wherever their crossings lie.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from perception.cable.polyline import arc_lengths
from perception.cable.topology.curve import Strand
from perception.cable.topology.diagram import Diagram, compact, partners_of, walked_faces


@dataclass(frozen=True, slots=True)
class Joined:
    """An open curve whose ends are joined over everything.

    Attributes:
        diagram: The closed curve: first all visits of the open one, among them where the joint
            runs over it, then those of the joint.
        places: Where each visit of the open curve is in the closed one.
    """

    diagram: Diagram
    places: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class OpenDiagram:
    """An open curve with n crossings.

    Attributes:
        visits: Number of the crossing at each of the 2n visits, numbered as they are met.
        over: Whether the strand is on top at that visit; each crossing once each way.
        signs: +1 or -1 for each crossing, as in `Diagram`.
        arcs: Where on the cable each visit lies, as a fraction of its length, growing.
    """

    visits: tuple[int, ...]
    over: tuple[bool, ...]
    signs: tuple[int, ...]
    arcs: tuple[float, ...] = field(compare=False)

    def __len__(self) -> int:
        """Return the number of crossings."""
        return len(self.signs)

    def partner(self, place: int) -> int:
        """Return the place of the other visit of the same crossing."""
        first = self.visits.index(self.visits[place])
        return first if first != place else self.visits.index(self.visits[place], place + 1)

    def span(self, edge: int) -> tuple[float, float]:
        """Return the arc positions between which an edge lies; edge e leads to visit e."""
        arcs = self.arcs
        return (arcs[edge - 1] if edge else 0.0, arcs[edge] if edge < len(arcs) else 1.0)

    def faces(self) -> tuple[list[int], list[int], int]:
        """Return the face to the left and to the right of each edge, and how many there are.

        Edge e leads to visit e; the last one, 2n, leads to the end of the curve.
        """
        other = partners_of(self.visits)
        return walked_faces(len(self.visits) + 1, partial(self._turn_left, other))

    def _turn_left(self, other: list[int], edge: int, forward: bool) -> tuple[int, bool]:
        """Return the next edge of the face on the left, and the way it is walked."""
        place = edge if forward else edge - 1
        if not 0 <= place < len(other):
            return edge, not forward
        goes_on = (forward == self.over[place]) == (self.signs[self.visits[place]] > 0)
        return (other[place] + 1, True) if goes_on else (other[place], False)

    def is_planar(self) -> bool:
        """Say whether it can be drawn in the plane: Euler's formula F = n + 1."""
        return self.faces()[2] == len(self) + 1

    def closed(self) -> Diagram:
        """Return the closed diagram with the ends joined over everything, the shortest way."""
        code = self.joined().diagram
        return compact(list(code.visits), list(code.over), dict(enumerate(code.signs)))

    def joined(self) -> "Joined":
        """Return the closed diagram, and which of its visits are the curve's own."""
        left, right, faces = self.faces()
        return self._joined_along(_way(_reached(left, right, faces), left[0]))

    def joined_beside(self, edges: range) -> "Joined | None":
        """Return the diagram closed by a joint that leaves some edges alone.

        Returns:
            What is joined; None where those edges shut one end in.
        """
        left, right, faces = self.faces()
        reached = _reached(left, right, faces, edges)
        return self._joined_along(_way(reached, left[0])) if left[0] in reached else None

    def _joined_along(self, way: list[tuple[int, bool]]) -> "Joined":
        crossed = {edge: len(self) + number for number, (edge, _) in enumerate(way)}
        visits: list[int] = []
        over: list[bool] = []
        places: list[int] = []
        for edge in range(len(self.visits) + 1):
            if edge in crossed:
                visits.append(crossed[edge])
                over.append(False)
            if edge < len(self.visits):
                places.append(len(visits))
                visits.append(self.visits[edge])
                over.append(self.over[edge])
        visits += [crossed[edge] for edge, _ in way]
        over += [True] * len(way)
        signs = self.signs + tuple(1 if from_left else -1 for _, from_left in way)
        return Joined(Diagram(tuple(visits), tuple(over), signs), tuple(places))

    def without(self, crossings: frozenset[int]) -> "OpenDiagram":
        """Return the diagram with these crossings left out."""
        kept = [p for p, crossing in enumerate(self.visits) if crossing not in crossings]
        return coded(
            [self.visits[p] for p in kept],
            [self.over[p] for p in kept],
            dict(enumerate(self.signs)),
            [self.arcs[p] for p in kept],
        )

    def backwards(self) -> "OpenDiagram":
        """Return the same cable followed from its other end."""
        return coded(
            list(self.visits[::-1]),
            list(self.over[::-1]),
            dict(enumerate(self.signs)),
            [1.0 - arc for arc in self.arcs[::-1]],
        )


def coded(
    visits: list[int], over: list[bool], sign_of: dict[int, int], arcs: list[float]
) -> OpenDiagram:
    """Return the open diagram of these visits with crossings numbered as they are met."""
    code = compact(visits, over, sign_of)
    return OpenDiagram(code.visits, code.over, code.signs, tuple(arcs))


def open_diagram(strand: Strand) -> OpenDiagram:
    """Return the diagram of a curve that was seen, with its crossings where they lie."""
    lengths = arc_lengths(strand.points)
    index = np.arange(len(lengths), dtype=float)
    met: list[tuple[float, int, bool]] = []
    signs: dict[int, int] = {}
    for number, crossing in enumerate(strand.crossings):
        met.append((crossing.first, number, crossing.first_over))
        met.append((crossing.second, number, not crossing.first_over))
        signs[number] = crossing.turn if crossing.first_over else -crossing.turn
    met.sort()
    at = np.interp([position for position, _, _ in met], index, lengths) / lengths[-1]
    return coded([m[1] for m in met], [m[2] for m in met], signs, [float(a) for a in at])


# How a face was come to: from which face, over which edge, from its left or not.
_Came = tuple[int, int, bool]


def _reached(
    left: Sequence[int], right: Sequence[int], faces: int, closed: range = range(0)
) -> dict[int, _Came | None]:
    """Return how each face is come to from that of the last edge, the shortest way."""
    doors: list[list[_Came]] = [[] for _ in range(faces)]
    for edge, (a, b) in enumerate(zip(left, right, strict=True)):
        if a != b and edge not in closed:
            doors[a].append((b, edge, True))
            doors[b].append((a, edge, False))
    came: dict[int, _Came | None] = {left[-1]: None}
    queue = deque(came)
    while queue:
        face = queue.popleft()
        for neighbour, edge, from_left in doors[face]:
            if neighbour not in came:
                came[neighbour] = (face, edge, from_left)
                queue.append(neighbour)
    return came


def _way(reached: dict[int, _Came | None], face: int) -> list[tuple[int, bool]]:
    """Return the edges that are crossed on the way to a face, as (edge, from its left)."""
    way: list[tuple[int, bool]] = []
    while (came := reached[face]) is not None:
        face, edge, from_left = came
        way.append((edge, from_left))
    return way[::-1]
