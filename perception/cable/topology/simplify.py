"""Make a diagram smaller by moves that do not change the knot.

First every move that saves crossings is made. Where none is left, moves that keep the
number of crossings are searched breadth first for a diagram from which one saves again.
"""

from collections import deque

from perception.cable.topology.diagram import Diagram, compact
from perception.cable.topology.passes import reroutes, runs


def simplify(diagram: Diagram, states: int = 200) -> Diagram:
    """Return a diagram of the same knot with as few crossings as the search finds.

    Args:
        diagram: A diagram that can be drawn on the sphere.
        states: How many diagrams of equal size are looked at before giving up.
    """
    smaller: Diagram | None = shorten(diagram)
    while smaller is not None:
        diagram = smaller
        smaller = _escape(diagram, states)
    return diagram


def shorten(diagram: Diagram) -> Diagram:
    """Return the diagram after every pass move that saves crossings."""
    shorter: Diagram | None = diagram
    while shorter is not None:
        diagram = shorter
        shorter = _shorter(diagram)
    return diagram


def _shorter(diagram: Diagram) -> Diagram | None:
    """Return the diagram after one move that saves crossings; None where there is none."""
    for run in sorted(runs(diagram), key=lambda run: -run.length):
        candidate = reroutes(diagram, run)[0]
        if len(candidate) < len(diagram):
            return candidate
    return None


def _escape(diagram: Diagram, states: int) -> Diagram | None:
    """Return a smaller diagram behind moves that save nothing themselves."""
    seen, queue = {_canonical(diagram)}, deque([diagram])
    while queue and len(seen) < states:
        current = queue.popleft()
        for run in runs(current):
            for neighbour in reroutes(current, run, limit=4):
                name = _canonical(neighbour)
                if name in seen:
                    continue
                seen.add(name)
                smaller = _shorter(neighbour)
                if smaller is not None:
                    return shorten(smaller)
                queue.append(neighbour)
    return None


def _canonical(diagram: Diagram) -> Diagram:
    """Return the same diagram however its curve was started and its crossings numbered."""
    count, sign_of = len(diagram.visits), dict(enumerate(diagram.signs))
    turned = (
        compact(
            list(diagram.visits[k:] + diagram.visits[:k]),
            list(diagram.over[k:] + diagram.over[:k]),
            sign_of,
        )
        for k in range(count)
    )
    return min(turned, key=lambda d: (d.visits, d.over, d.signs), default=diagram)
