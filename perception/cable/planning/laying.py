"""Lift a strand that runs over everything, or draw out one that runs under: where it may lie.

As `topology.passes` does with closed diagrams, but on an open curve, where a strand that is
lifted over an end would set that end free. Knots are about the curve with its ends joined over
everything, so a run on top lies below the joint, and is held back by where the joint comes
down. Join the ends beside the run: a way that does not cross this joint can be slid to from
the old one (on the sphere without joint, start and end of the run, a pair of pants, there is
but one simple way between the latter two). A run below passes under the joint, too, but can
only be drawn out sideways from under the others: its new way crosses nothing.
"""

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from perception.cable.planning.open_diagram import Joined, OpenDiagram, coded


@dataclass(frozen=True, slots=True)
class Stretch:
    """Neighbouring visits that are all over or all under.

    Attributes:
        first: Place of the first visit.
        last: Place of the last one.
    """

    first: int
    last: int

    @property
    def length(self) -> int:
        """Number of visits."""
        return self.last - self.first + 1

    @property
    def edges(self) -> range:
        """The edges before, between and after its visits."""
        return range(self.first, self.last + 2)


@dataclass(frozen=True, slots=True)
class Door:
    """How one gets from one face to the next.

    Attributes:
        face: The face behind it.
        edge: Edge of the open curve that is crossed.
        part: Which part of that edge, where the joint runs over it.
        from_left: Whether the edge is crossed from its left.
    """

    face: int
    edge: int
    part: int
    from_left: bool


def stretches(diagram: OpenDiagram) -> list[Stretch]:
    """Return the longest runs of a diagram, in the order of the curve."""
    over, count = diagram.over, len(diagram.over)
    starts = [p for p in range(count) if not p or over[p] != over[p - 1]]
    return [Stretch(a, b - 1) for a, b in zip(starts, [*starts[1:], count], strict=False)]


class Faces:
    """The faces of an open curve, from which runs can be lifted one at a time."""

    def __init__(self, diagram: OpenDiagram) -> None:
        """Find the faces once; the diagram must have crossings."""
        self._diagram = diagram
        self._left, self._right, _ = diagram.faces()
        self._shortest_joint = _Walls(diagram, diagram.joined())

    def way(self, run: Stretch) -> list[Door] | None:
        """Return what a run crosses when it is laid along its shortest way.

        Returns:
            The doors in order; None where a run below has to cross others, or one on top shuts
            an end in.
        """
        if self._diagram.over[run.first]:
            walls = self._beside(run)
            return walls.way(run) if walls else None
        return [] if self.crosses_nothing(run) else None

    def crosses_nothing(self, run: Stretch) -> bool:
        """Say whether a run can be laid so that it crosses nothing."""
        if self._diagram.over[run.first]:
            walls = self._beside(run)
            return walls is not None and walls.crosses_nothing(run)
        root = _merged(self._left, self._right, run.edges)
        return root(self._left[run.first]) == root(self._left[run.last + 1])

    def _beside(self, run: Stretch) -> "_Walls | None":
        """Return the faces with a joint beside a run; None where there can be none."""
        if not self._shortest_joint.cuts(run):
            return self._shortest_joint
        joined = self._diagram.joined_beside(run.edges)
        return None if joined is None else _Walls(self._diagram, joined)


class _Walls:
    """The faces between the curve and a joint that nothing may cross."""

    def __init__(self, diagram: OpenDiagram, joined: Joined) -> None:
        self._places = joined.places
        self._left, self._right, _ = joined.diagram.faces()
        own = len(joined.diagram.visits) - (len(joined.diagram) - len(diagram))
        self._own = own
        self._parts = self._parts_of_edges(own)

    def _parts_of_edges(self, own: int) -> list[tuple[int, int, int]]:
        """Return the parts of the curve's edges as (closed edge, edge, part)."""
        parts, real, edge, part = [], set(self._places), 0, 0
        for place in range(own):
            parts.append(((place - 1) % len(self._left), edge, part))
            edge, part = (edge + 1, 0) if place in real else (edge, part + 1)
        return [*parts, (own - 1, edge, part)]

    def _lifted(self, run: Stretch) -> list[int]:
        """Return the closed edges from the visit before a run, or the end, to that after it."""
        first = self._places[run.first - 1] if run.first else -1
        behind = run.last + 1 < len(self._places)
        last = self._places[run.last + 1] if behind else self._own
        return [edge % len(self._left) for edge in range(first, last)]

    def cuts(self, run: Stretch) -> bool:
        """Say whether the joint crosses a run."""
        return len(self._lifted(run)) != len(run.edges)

    def crosses_nothing(self, run: Stretch) -> bool:
        """Say whether a run on top can be laid so that it crosses nothing."""
        lifted = self._lifted(run)
        root = _merged(self._left, self._right, lifted)
        return root(self._left[lifted[0]]) == root(self._left[lifted[-1]])

    def way(self, run: Stretch) -> list[Door]:
        """Return what a run on top crosses along its shortest way beside the joint."""
        lifted = self._lifted(run)
        root = _merged(self._left, self._right, lifted)
        doors: dict[int, list[Door]] = {}
        for closed_edge, edge, part in self._parts:
            left, right = root(self._left[closed_edge]), root(self._right[closed_edge])
            if left != right and closed_edge not in lifted:
                doors.setdefault(left, []).append(Door(right, edge, part, from_left=True))
                doors.setdefault(right, []).append(Door(left, edge, part, from_left=False))
        return _shortest(doors, root(self._left[lifted[0]]), root(self._left[lifted[-1]]))


def _merged(left: list[int], right: list[int], lifted: Sequence[int]) -> Callable[[int], int]:
    """Return what says of each face which one it is part of when edges are lifted."""
    part_of: dict[int, int] = {}

    def root(face: int) -> int:
        while face in part_of:
            face = part_of[face]
        return face

    for edge in lifted:
        gone, kept = root(left[edge]), root(right[edge])
        if gone != kept:
            part_of[gone] = kept
    return root


def _shortest(doors: dict[int, list[Door]], source: int, target: int) -> list[Door]:
    """Search breadth first; the curve hangs together, so there is a way."""
    came: dict[int, tuple[int, Door]] = {}
    queue, seen = deque([source]), {source}
    while target not in seen:
        face = queue.popleft()
        for door in doors[face]:
            if door.face not in seen:
                seen.add(door.face)
                came[door.face] = (face, door)
                queue.append(door.face)
    way: list[Door] = []
    while target != source:
        target, door = came[target]
        way.append(door)
    return way[::-1]


def laid(diagram: OpenDiagram, run: Stretch, way: list[Door]) -> OpenDiagram:
    """Return the diagram with the crossings of a run replaced by those along a way."""
    on_top = diagram.over[run.first]
    lifted = frozenset(diagram.visits[run.first : run.last + 1])
    if not way:
        return diagram.without(lifted)
    signs = dict(enumerate(diagram.signs))
    begin, end = diagram.span(run.first)[0], diagram.span(run.last + 1)[1]
    met = [
        (arc, visit, over)
        for arc, visit, over in zip(diagram.arcs, diagram.visits, diagram.over, strict=True)
        if visit not in lifted
    ]
    step = (end - begin) / (len(way) + 1)
    for k, door in enumerate(way, start=1):
        number = len(diagram) + k - 1
        signs[number] = 1 if door.from_left == on_top else -1
        met.append((begin + k * step, number, on_top))
        met.append((_arc_on(diagram, door, way), number, not on_top))
    met.sort()
    return coded([m[1] for m in met], [m[2] for m in met], signs, [m[0] for m in met])


def _arc_on(diagram: OpenDiagram, door: Door, way: list[Door]) -> float:
    """Return where on the cable a way crosses an edge, in order where it does so twice."""
    parts = sorted(other.part for other in way if other.edge == door.edge)
    begin, end = diagram.span(door.edge)
    return begin + (end - begin) * (parts.index(door.part) + 1) / (len(parts) + 1)
