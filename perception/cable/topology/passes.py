"""Pass moves: lay a strand that runs over (or under) everything along a shorter way.

A run of neighbouring over-visits can be lifted and put down anywhere else, as long as it
stays on top and keeps its ends. Reidemeister I and II, and III where it leads to fewer
crossings, are special cases, so shortening runs until none gets shorter simplifies well.
"""

from collections import deque
from dataclasses import dataclass
from functools import lru_cache

from perception.cable.topology.diagram import Diagram, compact


@dataclass(frozen=True, slots=True)
class Run:
    """Neighbouring visits that are all over or all under.

    Attributes:
        start: Place of the first visit.
        length: Number of visits.
    """

    start: int
    length: int


def runs(diagram: Diagram) -> list[Run]:
    """Return the longest runs of a diagram, in the order of the curve."""
    over, count = diagram.over, len(diagram.over)
    starts = [place for place in range(count) if over[place] != over[place - 1]]
    ends = [*starts[1:], starts[0] + count] if starts else []
    return [Run(a, b - a) for a, b in zip(starts, ends, strict=True)]


class _Map:
    """Faces of a diagram from which a run has been lifted; faces it divided are joined."""

    def __init__(self, diagram: Diagram, run: Run) -> None:
        left, right, faces = _faces_of(diagram)
        count, other = len(diagram.visits), diagram.partners()
        self.parent = list(range(faces))
        lifted = {(run.start - 1 + step) % count for step in range(run.length + 1)}
        for edge in lifted:
            self.parent[self._root(left[edge])] = self._root(right[edge])
        self.source = self._root(left[(run.start - 1) % count])
        self.target = self._root(left[(run.start + run.length - 1) % count])
        # Where the run passed another strand, one edge is left of two.
        joined = {other[(run.start + step) % count] for step in range(run.length)}
        second = {edge for edge in joined if (edge - 1) % count not in lifted}
        self.doors: list[list[tuple[int, int, bool]]] = [[] for _ in range(faces)]
        for edge in range(count):
            a, b = self._root(left[edge]), self._root(right[edge])
            if a != b and edge not in lifted and edge not in second:
                self.doors[a].append((b, edge, True))
                self.doors[b].append((a, edge, False))

    def _root(self, face: int) -> int:
        while self.parent[face] != face:
            self.parent[face] = self.parent[self.parent[face]]
            face = self.parent[face]
        return face

    def distances(self) -> dict[int, int]:
        """Return how many edges lie between each face and the target."""
        steps, queue = {self.target: 0}, deque([self.target])
        while queue:
            face = queue.popleft()
            for neighbour, _, _ in self.doors[face]:
                if neighbour not in steps:
                    steps[neighbour] = steps[face] + 1
                    queue.append(neighbour)
        return steps

    def shortest_ways(self, limit: int) -> list[list[tuple[int, bool]]]:
        """Return up to `limit` shortest ways as (edge, crossed from its left) lists."""
        steps = self.distances()
        ways: list[tuple[int, list[tuple[int, bool]]]] = [(self.source, [])]
        for remaining in range(steps[self.source] - 1, -1, -1):
            ways = [
                (neighbour, [*way, (edge, from_left)])
                for face, way in ways
                for neighbour, edge, from_left in self.doors[face]
                if steps[neighbour] == remaining
            ][:limit]
        return [way for _, way in ways]


@lru_cache(maxsize=64)
def _faces_of(diagram: Diagram) -> tuple[list[int], list[int], int]:
    """Return the faces of a diagram, which all of its runs ask for."""
    return diagram.faces()


def shortcut(diagram: Diagram, run: Run) -> Diagram | None:
    """Return the diagram with `run` laid along a way that saves crossings; None for none."""
    lifted = _Map(diagram, run)
    if lifted.distances()[lifted.source] >= run.length:
        return None
    return lay(diagram, run, lifted.shortest_ways(1)[0])


def reroutes(diagram: Diagram, run: Run, limit: int = 1) -> list[Diagram]:
    """Return the diagrams with `run` laid along its shortest ways, at most `limit` of them."""
    ways = _Map(diagram, run).shortest_ways(limit)
    return [lay(diagram, run, way) for way in ways]


def lay(diagram: Diagram, run: Run, way: list[tuple[int, bool]]) -> Diagram:
    """Return the diagram with the crossings of `run` replaced by those along `way`.

    Args:
        diagram: The diagram.
        run: What is lifted.
        way: Each edge that is crossed instead, and whether it is crossed from its left.

    Returns:
        The diagram; it starts with the visits of the new way.
    """
    count, on_top = len(diagram.visits), diagram.over[run.start]
    turned = [*range(run.start, count), *range(run.start)]
    lifted = {diagram.visits[place] for place in turned[: run.length]}
    sign_of = dict(enumerate(diagram.signs))
    if not way:
        left = [place for place in turned if diagram.visits[place] not in lifted]
        return compact([diagram.visits[k] for k in left], [diagram.over[k] for k in left], sign_of)
    new_at: dict[int, int] = {}
    for number, (edge, from_left) in enumerate(way, start=len(diagram)):
        new_at[edge] = number
        sign_of[number] = 1 if from_left == on_top else -1
    visits, over = list(range(len(diagram), len(diagram) + len(way))), [on_top] * len(way)
    for step, place in enumerate(turned[run.length - 1 :], start=run.length - 1):
        if step >= run.length and diagram.visits[place] not in lifted:
            visits.append(diagram.visits[place])
            over.append(diagram.over[place])
        if place in new_at:
            visits.append(new_at[place])
            over.append(not on_top)
    return compact(visits, over, sign_of)
