"""Make a diagram smaller by moves that do not change the knot.

First every move that saves crossings is made. Where none is left, moves that keep the
number of crossings are searched breadth first for a diagram from which one saves again.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

from perception.cable.topology.diagram import Diagram, compact
from perception.cable.topology.passes import Run, reroutes, runs


@dataclass(frozen=True, slots=True)
class Step:
    """One pass move.

    Attributes:
        run: What is lifted off the diagram before.
        after: The diagram after; its first visits are the way that the run was laid along.
    """

    run: Run
    after: Diagram


def simplify(diagram: Diagram, states: int = 200) -> Diagram:
    """Return a diagram of the same knot with as few crossings as the search finds.

    Args:
        diagram: A diagram that can be drawn on the sphere.
        states: How many diagrams of equal size are looked at before giving up.
    """
    return _last(diagram, simplification(diagram, states))


def simplification(diagram: Diagram, states: int = 200) -> tuple[Step, ...]:
    """Return the moves that lead to as few crossings as the search finds; see `simplify`."""
    steps = _shortening(diagram)
    while more := _escape(_last(diagram, steps), states):
        steps += more
    return tuple(steps)


def shorten(diagram: Diagram) -> Diagram:
    """Return the diagram after every pass move that saves crossings."""
    return _last(diagram, _shortening(diagram))


def _last(diagram: Diagram, steps: Sequence[Step]) -> Diagram:
    return steps[-1].after if steps else diagram


def _shortening(diagram: Diagram) -> list[Step]:
    """Return moves that save crossings, until none is left."""
    steps: list[Step] = []
    while (step := _shorter(_last(diagram, steps))) is not None:
        steps.append(step)
    return steps


def _shorter(diagram: Diagram) -> Step | None:
    """Return one move that saves crossings; None where there is none."""
    for run in sorted(runs(diagram), key=lambda run: -run.length):
        candidate = reroutes(diagram, run)[0]
        if len(candidate) < len(diagram):
            return Step(run, candidate)
    return None


def _escape(diagram: Diagram, states: int) -> list[Step]:
    """Return moves to a smaller diagram behind ones that save nothing; empty for none found."""
    seen, queue = {_canonical(diagram)}, deque[list[Step]]([[]])
    while queue and len(seen) < states:
        steps = queue.popleft()
        current = _last(diagram, steps)
        for run in runs(current):
            for neighbour in reroutes(current, run, limit=4):
                name = _canonical(neighbour)
                if name in seen:
                    continue
                seen.add(name)
                ahead = [*steps, Step(run, neighbour)]
                smaller = _shorter(neighbour)
                if smaller is not None:
                    return [*ahead, smaller, *_shortening(smaller.after)]
                queue.append(ahead)
    return []


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
