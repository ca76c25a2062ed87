"""Diagrams made harder by moves that add crossings: the inverses of those that take them out."""

from itertools import product

import numpy as np

from perception.cable.topology import Diagram
from perception.cable.topology.moves import slides

UNKNOT = Diagram((), (), ())


def with_loop(diagram: Diagram, edge: int, sign: int, over_first: bool) -> Diagram:
    """Reidemeister I backwards: an edge gets a loop behind the visit that it leaves."""
    new, at = len(diagram), edge + 1
    return Diagram(
        (*diagram.visits[:at], new, new, *diagram.visits[at:]),
        (*diagram.over[:at], over_first, not over_first, *diagram.over[at:]),
        (*diagram.signs, sign),
    )


def with_bigon(diagram: Diagram, upper: int, lower: int) -> list[Diagram]:
    """Reidemeister II backwards: an edge is laid over another; all ways that the plane allows."""
    new, found = len(diagram), []
    for turned, sign in product((False, True), (1, -1)):
        visits, over = list(diagram.visits), list(diagram.over)
        below = (new + 1, new) if turned else (new, new + 1)
        pieces = [(upper + 1, (new, new + 1), True), (lower + 1, below, False)]
        for at, pair, on_top in sorted(pieces, reverse=True):
            visits[at:at], over[at:at] = pair, [on_top] * 2
        made = Diagram(tuple(visits), tuple(over), (*diagram.signs, sign, -sign))
        found += [made] if made.is_planar() else []
    return found


def scrambled(diagram: Diagram, rng: np.random.Generator, crossings: int) -> Diagram:
    """Return a diagram of the same knot with at least so many crossings."""
    while len(diagram) < crossings:
        edges = max(2 * len(diagram), 1)
        if rng.random() < 0.3 or edges < 4:
            edge = int(rng.integers(edges)) if diagram.visits else -1
            diagram = with_loop(
                diagram, edge, int(rng.choice([-1, 1])), over_first=bool(rng.random() < 0.5)
            )
        else:
            upper, lower = (int(edge) for edge in rng.choice(edges, 2, replace=False))
            found = with_bigon(diagram, upper, lower)
            diagram = found[int(rng.integers(len(found)))] if found else diagram
        for _ in range(2):
            turned = [step.after for step in slides(diagram)]
            diagram = turned[int(rng.integers(len(turned)))] if turned else diagram
    return diagram
