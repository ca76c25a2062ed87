"""Lists the moves on a diagram: those of its ends, and those between them."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from perception.cable.planning.inner_moves import inner_moves
from perception.cable.planning.moves import Hold, Move, MoveKind
from perception.cable.planning.open_diagram import OpenDiagram
from perception.cable.topology.alexander import alexander_polynomial

Polynomial = tuple[int, ...]

# Fewer crossings than this cannot lock when they are pulled at from one side.
LOCKING = 3


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
        found = [*self._end_moves(diagram), *inner_moves(diagram)]
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
        others = frozenset(diagram.visits) - own
        return self.polynomial(diagram.without(others)) != (1,)

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
