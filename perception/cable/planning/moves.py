"""What a robot can do to a cable on a table, and the diagram that each move should leave.

Ends: lift one off what it lies on, pull one out from under other strands, or draw it through a
loop of a knot (cage-pinch dilation: the loop is held, the cable slides through a cage). Nothing
else changes the knot of an open cable. Between the ends: untwist a loop (Reidemeister I), pull
two strands apart (II), lay a strand that runs on top elsewhere (passes, with them III), or draw
one out sideways from under others. No move is offered that leaves more crossings.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Literal

from perception.cable.planning.laying import Faces, Stretch, laid, stretches
from perception.cable.planning.open_diagram import OpenDiagram, coded
from perception.cable.topology.alexander import alexander_polynomial

End = Literal["start", "finish"]
Role = Literal["pinch", "cage"]
Polynomial = tuple[int, ...]

# Fewer crossings than this cannot lock when they are pulled at from one side.
LOCKING = 3


class MoveKind(StrEnum):
    """What hands do."""

    LIFT_END = "lift_end"
    PULL_OUT = "pull_out"
    DILATE = "dilate"
    UNTWIST = "untwist"
    PULL_APART = "pull_apart"
    LAY_OVER = "lay_over"
    DRAW_OUT = "draw_out"


END_MOVES = frozenset({MoveKind.LIFT_END, MoveKind.PULL_OUT, MoveKind.DILATE})


@dataclass(frozen=True, slots=True)
class Hold:
    """Where a hand may take the cable.

    Attributes:
        role: Whether the cable is held or slides.
        interval: Arc positions between which it may be taken.
        near: Arc position that would be best if there were room everywhere.
    """

    role: Role
    interval: tuple[float, float]
    near: float


@dataclass(frozen=True, slots=True)
class Move:
    """One move on a diagram.

    Attributes:
        kind: What is done.
        end: Which end is moved; None for none.
        interval: Arc positions between which the cable is moved.
        holds: Where it is held, one a hand.
        passed: Visits that are undone or laid elsewhere.
        below: How many of these run under another strand.
        predicted: The diagram that should be left.
        stays: The edge behind what an end is drawn from, as arc positions; None for no end.
        across: Arc positions of the strands that a run is laid over anew.
    """

    kind: MoveKind
    end: End | None
    interval: tuple[float, float]
    holds: tuple[Hold, ...]
    passed: int
    below: int
    predicted: OpenDiagram
    stays: tuple[float, float] | None = None
    across: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class MoveRules:
    """What the robot may do.

    Attributes:
        free_ends: Whether the first and the last end can be moved.
        most_passed: Past how many visits an end is drawn in one move; more, and friction
            around the strands that it bends about wins over the hand.
        most_loops: From below how many strands an end is drawn when that undoes a knot; more,
            and the knot is pulled tight before the end comes free.
    """

    free_ends: tuple[bool, bool] = (True, True)
    most_passed: int = 4
    most_loops: int = 1


@dataclass(slots=True)
class MoveFinder:
    """Lists moves; remembers the polynomials of diagrams, which tell if a knot was changed."""

    rules: MoveRules = field(default_factory=MoveRules)
    _polynomials: dict[OpenDiagram, Polynomial] = field(default_factory=dict)

    def moves(self, diagram: OpenDiagram) -> list[Move]:
        """Return all moves that leave fewer crossings, or if there are none, as many."""
        if not diagram.visits:
            return []
        found = [*self._end_moves(diagram), *_inner_moves(diagram)]
        fewer = [move for move in found if len(move.predicted) < len(diagram)]
        return fewer or [move for move in found if move.predicted != diagram]

    def _end_moves(self, diagram: OpenDiagram) -> Iterator[Move]:
        if self.rules.free_ends[0]:
            yield from self._moves_of_start(diagram)
        if self.rules.free_ends[1]:
            yield from map(_turned, self._moves_of_start(diagram.backwards()))

    def _moves_of_start(self, diagram: OpenDiagram) -> Iterator[Move]:
        for count in range(1, min(self.rules.most_passed, len(diagram.visits)) + 1):
            if all(diagram.over[:count]):
                yield _lift_end(diagram, count)
            elif not self._locks(diagram, count):
                yield from self._pull(diagram, count)

    def _locks(self, diagram: OpenDiagram, count: int) -> bool:
        """Say whether pulling at the first visits would draw a knot of their own tight."""
        own = set(diagram.visits[:count]) - set(diagram.visits[count:])
        if len(own) < LOCKING:
            return False
        return self.polynomial(_piece(diagram, count, own)) != (1,)

    def _pull(self, diagram: OpenDiagram, count: int) -> Iterator[Move]:
        """Yield the pull past the first visits; none where a knot has no loop to hold."""
        after = diagram.without(frozenset(diagram.visits[:count]))
        loop, hold = _loop_around(diagram, count), diagram.span(count)
        below = diagram.over[:count].count(False)
        kind = MoveKind.PULL_OUT
        holds: tuple[Hold, ...] = (Hold("pinch", hold, hold[0]),)
        if self.polynomial(diagram) != self.polynomial(after):
            if loop is None or below > self.rules.most_loops:
                return
            kind = MoveKind.DILATE
            holds = (Hold("cage", hold, hold[0]), _hold_on_top(diagram, loop, count))
        moved = (0.0, diagram.arcs[count - 1])
        yield Move(kind, "start", moved, holds, count, below, after, diagram.span(count))

    def polynomial(self, diagram: OpenDiagram) -> Polynomial:
        """Return the Alexander polynomial of a diagram with its ends joined."""
        if diagram not in self._polynomials:
            self._polynomials[diagram] = alexander_polynomial(diagram.closed())
        return self._polynomials[diagram]


def _lift_end(diagram: OpenDiagram, count: int) -> Move:
    tip = (0.0, diagram.arcs[0])
    return Move(
        MoveKind.LIFT_END,
        "start",
        (0.0, diagram.arcs[count - 1]),
        (Hold("pinch", tip, 0.0),),
        passed=count,
        below=0,
        predicted=diagram.without(frozenset(diagram.visits[:count])),
        stays=diagram.span(count),
    )


def _piece(diagram: OpenDiagram, count: int, crossings: set[int]) -> OpenDiagram:
    """Return the first visits, with only the given crossings."""
    kept = [p for p in range(count) if diagram.visits[p] in crossings]
    return coded(
        [diagram.visits[p] for p in kept],
        [diagram.over[p] for p in kept],
        dict(enumerate(diagram.signs)),
        [diagram.arcs[p] for p in kept],
    )


def _loop_around(diagram: OpenDiagram, count: int) -> int | None:
    """Return the place where a strand that stays lies over the last of the first visits."""
    for place in range(count - 1, -1, -1):
        if not diagram.over[place] and (above := diagram.partner(place)) >= count:
            return above
    return None


def _hold_on_top(diagram: OpenDiagram, place: int, count: int) -> Hold:
    """Return where to pinch the strand on top, from the undercrossing before it.

    Beyond it the pinch would be outside of the loop, and pull it tight.
    """
    low = place
    while low > count and diagram.over[low - 1]:
        low -= 1
    return Hold("pinch", (diagram.span(low)[0], diagram.arcs[place]), diagram.arcs[place])


def _turned(move: Move) -> Move:
    """Return a move of the first end as one of the last: the curve was followed backwards."""

    def flipped(interval: tuple[float, float]) -> tuple[float, float]:
        return 1.0 - interval[1], 1.0 - interval[0]

    return replace(
        move,
        end="finish",
        interval=flipped(move.interval),
        holds=tuple(Hold(h.role, flipped(h.interval), 1.0 - h.near) for h in move.holds),
        predicted=move.predicted.backwards(),
        stays=flipped(move.stays) if move.stays else None,
    )


def _inner_moves(diagram: OpenDiagram) -> Iterator[Move]:
    """Return moves of strands between the ends, each run as a whole, and twists and bights."""
    faces = Faces(diagram)
    for longest in stretches(diagram):
        runs = {longest} | {
            Stretch(first, first + more)
            for more in (0, 1)
            for first in range(longest.first, longest.last + 1 - more)
        }
        for run in sorted(runs, key=lambda run: (run.first, run.last)):
            yield from _laid_elsewhere(diagram, faces, run, longest)


def _laid_elsewhere(
    diagram: OpenDiagram, faces: Faces, run: Stretch, longest: Stretch
) -> Iterator[Move]:
    if run != longest and not faces.crosses_nothing(run):
        return
    way = faces.way(run) if run == longest else []
    if way is None:
        return
    on_top = diagram.over[run.first]
    interval = (diagram.span(run.first)[0], diagram.span(run.last + 1)[1])
    kind = _kind(diagram, run, on_top) if not way else MoveKind.LAY_OVER
    is_loop = kind is MoveKind.UNTWIST
    holds = _beside_loop(diagram, run.first) if is_loop else (_amid(diagram, run, interval),)
    yield Move(
        kind,
        None,
        interval,
        holds,
        passed=run.length + len(way),
        below=0 if on_top else run.length,
        predicted=laid(diagram, run, way),
        across=tuple(sum(diagram.span(door.edge)) / 2.0 for door in way),
    )


def _amid(diagram: OpenDiagram, run: Stretch, interval: tuple[float, float]) -> Hold:
    """Return where to take a run: between its visits where it is on top, else anywhere."""
    inner = (diagram.arcs[run.first], diagram.arcs[run.last])
    free = diagram.over[run.first] and run.length > 1
    return Hold("pinch", inner if free else interval, sum(inner) / 2.0)


def _kind(diagram: OpenDiagram, run: Stretch, on_top: bool) -> MoveKind:
    """Name a run that crosses nothing where it is laid."""
    others = [diagram.partner(place) for place in range(run.first, run.last + 1)]
    if run.length == 1 and abs(others[0] - run.first) == 1:
        return MoveKind.UNTWIST
    if run.length == 2 and abs(others[0] - others[1]) == 1:
        return MoveKind.PULL_APART
    return MoveKind.LAY_OVER if on_top else MoveKind.DRAW_OUT


def _beside_loop(diagram: OpenDiagram, place: int) -> tuple[Hold, ...]:
    """Return where to hold on both sides of a loop to pull it straight."""
    first, second = sorted((place, diagram.partner(place)))
    before, after = diagram.span(first), diagram.span(second + 1)
    return Hold("pinch", before, before[1]), Hold("pinch", after, after[0])
