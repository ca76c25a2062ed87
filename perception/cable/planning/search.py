"""Uniform-cost search over diagrams, guided by how many crossings are left."""

import heapq
from collections.abc import Callable
from dataclasses import dataclass
from itertools import count

from perception.cable.planning.moves import Move
from perception.cable.planning.open_diagram import OpenDiagram


@dataclass(frozen=True, slots=True)
class Found:
    """What a search came to.

    Attributes:
        moves: The cheapest moves to a goal, in order; None where none was found.
        cost: What they cost together.
        states: How many diagrams were looked at.
        exhausted: Whether there was nothing left to look at.
    """

    moves: tuple[Move, ...] | None
    cost: float
    states: int
    exhausted: bool


@dataclass(frozen=True, slots=True)
class Problem:
    """What is searched.

    Attributes:
        moves: Lists the moves on a diagram, each with its cost.
        left: A guess of what the rest costs, 0 for goals. Where it is never too high and never
            falls by more than a move costs, the moves found are the cheapest.
        is_goal: Whether nothing is left to do.
    """

    moves: Callable[[OpenDiagram], list[tuple[Move, float]]]
    left: Callable[[OpenDiagram], float]
    is_goal: Callable[[OpenDiagram], bool]


def cheapest(start: OpenDiagram, problem: Problem, states: int) -> Found:
    """Return the cheapest moves from a diagram to a goal (A*: P. Hart et al. 1968).

    Args:
        start: Where to begin.
        problem: What is searched.
        states: How many diagrams are looked at before giving up.
    """
    best, came, done = (
        {start: 0.0},
        dict[OpenDiagram, tuple[OpenDiagram, Move]](),
        set[OpenDiagram](),
    )
    order = count()
    queue = [(0.0, next(order), start)]
    while queue and len(done) < states:
        _, _, here = heapq.heappop(queue)
        if here in done:
            continue
        done.add(here)
        if problem.is_goal(here):
            return Found(_traced(came, start, here), best[here], len(done), exhausted=False)
        for move, cost in problem.moves(here):
            there, total = move.predicted, best[here] + cost
            if total < best.get(there, total + 1.0):
                best[there], came[there] = total, (here, move)
                heapq.heappush(queue, (total + problem.left(there), next(order), there))
    return Found(None, 0.0, len(done), exhausted=not queue)


def _traced(
    came: dict[OpenDiagram, tuple[OpenDiagram, Move]], start: OpenDiagram, goal: OpenDiagram
) -> tuple[Move, ...]:
    moves: list[Move] = []
    while goal != start:
        goal, move = came[goal]
        moves.append(move)
    return tuple(reversed(moves))
