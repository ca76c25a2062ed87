"""The moves of knot theory, each by its name.

Reidemeister I takes a loop out, II pulls a strand off another that it lies over twice, III
slides a strand over a crossing (K. Reidemeister 1927). A pass move lays a strand that runs over
(or under) everything along another way; it is made of moves of these three kinds.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum

from perception.cable.topology.diagram import Diagram, compact
from perception.cable.topology.passes import Run, lay


class MoveKind(StrEnum):
    """What a move is called."""

    REIDEMEISTER_1 = "RI"
    REIDEMEISTER_2 = "RII"
    REIDEMEISTER_3 = "RIII"
    PASS = "pass"


@dataclass(frozen=True, slots=True)
class Step:
    """One move.

    Attributes:
        kind: What it is called; a pass move that is one of the three others bears their name.
        run: What is lifted off the diagram before.
        after: The diagram after; its first visits are the way that the run was laid along.
    """

    kind: MoveKind
    run: Run
    after: Diagram


def first_loop(diagram: Diagram) -> Step | None:
    """Return Reidemeister I at the first loop; None where no loop is empty."""
    visits = diagram.visits
    for place, crossing in enumerate(visits):
        if visits[place - 1] == crossing:
            run = Run((place - 1) % len(visits), 1)
            return Step(MoveKind.REIDEMEISTER_1, run, lay(diagram, run, []))
    return None


def first_bigon(diagram: Diagram) -> Step | None:
    """Return Reidemeister II at the first two strands that can be pulled apart; None for none.

    The strands meet at two neighbouring crossings, one strand on top at both. They bound a face
    where the lower strand crosses to one side and back, so that the signs are unlike.
    """
    visits, over, signs, other = diagram.visits, diagram.over, diagram.signs, diagram.partners()
    count = len(visits)
    for place in range(count):
        a, b = place - 1, place
        if over[a] and over[b] and signs[visits[a]] != signs[visits[b]]:
            apart = (other[a] - other[b]) % count
            if apart in (1, count - 1):
                run = Run(a % count, 2)
                return Step(MoveKind.REIDEMEISTER_2, run, lay(diagram, run, []))
    return None


def slides(diagram: Diagram) -> Iterator[Step]:
    """Yield Reidemeister III at each triangle whose one strand lies over (or under) both others."""
    over, visits, count = diagram.over, diagram.visits, len(diagram.over)
    for edges in _triangles(diagram):
        for side in edges:
            start, end = side, (side + 1) % count
            if over[start] == over[end]:
                sides = [(edge, (edge + 1) % count) for edge in (side, *(edges - {side}))]
                if len({visits[place] for pair in sides for place in pair}) == 3:
                    slid = _slid(diagram, sides)
                    yield Step(MoveKind.REIDEMEISTER_3, Run(start, 2), slid)


def _triangles(diagram: Diagram) -> list[set[int]]:
    """Return the edges of each face that has three."""
    left, right, faces = diagram.faces()
    edges: list[list[int]] = [[] for _ in range(faces)]
    for sides in (left, right):
        for edge, face in enumerate(sides):
            edges[face].append(edge)
    return [set(face) for face in edges if len(face) == len(set(face)) == 3]


def _slid(diagram: Diagram, sides: list[tuple[int, int]]) -> Diagram:
    """Return the diagram with the ends of all three sides exchanged, from the first side on."""
    visits, over, start = list(diagram.visits), list(diagram.over), sides[0][0]
    for a, b in sides:
        visits[a], visits[b] = visits[b], visits[a]
        over[a], over[b] = over[b], over[a]
    sign_of = dict(enumerate(diagram.signs))
    return compact(visits[start:] + visits[:start], over[start:] + over[:start], sign_of)
