"""Make a diagram smaller by moves that do not change the knot.

First every move that saves crossings is made: Reidemeister I, then II, then pass moves. Where
none is left, moves that keep the number of crossings are searched breadth first for a diagram
from which one saves again.
"""

from collections import deque
from collections.abc import Iterator, Sequence

from perception.cable.topology.diagram import Diagram
from perception.cable.topology.moves import MoveKind, Step, first_bigon, first_loop, slides
from perception.cable.topology.passes import reroutes, runs, shortcut

# Diagrams of equal size that are looked at before giving up.
STATES = 200
# Shortest ways of one run that are tried.
WAYS = 4


def simplify(diagram: Diagram, states: int = STATES) -> Diagram:
    """Return a diagram of the same knot with as few crossings as the search finds.

    Args:
        diagram: A diagram that can be drawn on the sphere.
        states: How many diagrams of equal size are looked at before giving up.
    """
    return reached(diagram, simplification(diagram, states))


def simplification(diagram: Diagram, states: int = STATES) -> tuple[Step, ...]:
    """Return the moves that lead to as few crossings as the search finds; see `simplify`."""
    steps = shortening(diagram)
    return (*steps, *search(reached(diagram, steps), states))


def cancel(diagram: Diagram) -> Diagram:
    """Return the diagram after every Reidemeister I and II that saves crossings."""
    while diagram.visits and (step := first_loop(diagram) or first_bigon(diagram)) is not None:
        diagram = step.after
    return diagram


def shorten(diagram: Diagram) -> Diagram:
    """Return the diagram after every move that saves crossings."""
    return reached(diagram, shortening(diagram))


def reached(diagram: Diagram, steps: Sequence[Step]) -> Diagram:
    """Return the diagram that moves lead to."""
    return steps[-1].after if steps else diagram


def shortening(diagram: Diagram) -> list[Step]:
    """Return moves that save crossings, until none is left."""
    steps: list[Step] = []
    while (step := _shorter(reached(diagram, steps))) is not None:
        steps.append(step)
    return steps


def search(diagram: Diagram, states: int) -> list[Step]:
    """Return moves to a smaller diagram from one that no single move makes smaller.

    Args:
        diagram: What `shortening` leads to.
        states: How many diagrams of equal size are looked at each time before giving up.
    """
    steps: list[Step] = []
    while more := _escape(reached(diagram, steps), states):
        steps += more
    return steps


def _shorter(diagram: Diagram) -> Step | None:
    """Return one move that saves crossings; None where there is none."""
    if not diagram.visits:
        return None
    return first_loop(diagram) or first_bigon(diagram) or _shorter_pass(diagram)


def _shorter_pass(diagram: Diagram) -> Step | None:
    for run in sorted(runs(diagram), key=lambda run: -run.length):
        shorter = shortcut(diagram, run)
        if shorter is not None:
            return Step(MoveKind.PASS, run, shorter)
    return None


def is_alternating(diagram: Diagram) -> bool:
    """Say whether over and under take turns.

    An alternating diagram without a crossing that a pass move takes out has the fewest
    crossings of its knot (L. Kauffman, K. Murasugi, M. Thistlethwaite 1987).
    """
    return all(diagram.over[place] != diagram.over[place - 1] for place in range(len(diagram.over)))


def _escape(diagram: Diagram, states: int) -> list[Step]:
    """Return moves to a smaller diagram behind ones that save nothing; empty for none found."""
    if is_alternating(diagram):
        return []
    seen, queue = {diagram.cyclic_name()}, deque[list[Step]]([[]])
    while queue:
        steps = queue.popleft()
        for step in _sideways(reached(diagram, steps)):
            name = step.after.cyclic_name()
            if name in seen:
                continue
            if len(seen) >= states:
                return []
            seen.add(name)
            ahead = [*steps, step]
            smaller = _shorter(step.after)
            if smaller is not None:
                return [*ahead, smaller, *shortening(smaller.after)]
            queue.append(ahead)
    return []


def _sideways(diagram: Diagram) -> Iterator[Step]:
    """Yield moves that keep the number of crossings, Reidemeister III first."""
    yield from slides(diagram)
    for run in runs(diagram):
        for neighbour in reroutes(diagram, run, WAYS):
            yield Step(MoveKind.PASS, run, neighbour)
