"""Did what was predicted come true? Compares the diagram after a move with the one seen."""

from enum import StrEnum
from itertools import pairwise

from perception.cable.planning.open_diagram import OpenDiagram
from perception.cable.topology.alexander import alexander_polynomial


class Agreement(StrEnum):
    """How alike two diagrams are, the closest first."""

    SAME = "same"
    BUT_FOR_TWISTS = "same but for twists and bights"
    BUT_FOR_ENDS = "same but for ends that lie upon strands, too"
    SAME_KNOT = "maybe the same knot"
    DIFFERENT = "different"


def agrees(predicted: OpenDiagram, seen: OpenDiagram) -> bool:
    """Say whether a diagram is the predicted one, but for crossings that mean nothing.

    Loops that a twist undoes, strands that can be pulled apart, and ends that lie upon others
    come about by chance when cable is laid down.
    """
    close = {Agreement.SAME, Agreement.BUT_FOR_TWISTS, Agreement.BUT_FOR_ENDS}
    return agreement(predicted, seen) in close


def agreement(predicted: OpenDiagram, seen: OpenDiagram) -> Agreement:
    """Return how alike two diagrams are, whichever end each was followed from."""
    for level, form in (
        (Agreement.SAME, lambda diagram: diagram),
        (Agreement.BUT_FOR_TWISTS, without_twists),
        (Agreement.BUT_FOR_ENDS, without_laid_ends),
    ):
        if form(seen) in (form(predicted), form(predicted.backwards())):
            return level
    both = [alexander_polynomial(diagram.closed()) for diagram in (predicted, seen)]
    return Agreement.SAME_KNOT if both[0] == both[1] else Agreement.DIFFERENT


def without_twists(diagram: OpenDiagram) -> OpenDiagram:
    """Return the diagram after Reidemeister moves I and II, made to an end."""
    while gone := _twist(diagram) or _bight(diagram):
        diagram = diagram.without(gone)
    return diagram


def without_laid_ends(diagram: OpenDiagram) -> OpenDiagram:
    """Return the diagram after these moves, and with ends lifted off what they lie on."""
    diagram = without_twists(diagram)
    while gone := _under_end(diagram):
        diagram = without_twists(diagram.without(gone))
    return diagram


def _under_end(diagram: OpenDiagram) -> frozenset[int]:
    """Return a crossing that an end lies upon."""
    ends = [k for k in (0, -1) if diagram.visits and diagram.over[k]]
    return frozenset(diagram.visits[k] for k in ends[:1])


def _twist(diagram: OpenDiagram) -> frozenset[int]:
    """Return the crossing of a loop that nothing runs through; empty for none."""
    for here, after in pairwise(diagram.visits):
        if here == after:
            return frozenset({here})
    return frozenset()


def _bight(diagram: OpenDiagram) -> frozenset[int]:
    """Return two crossings of a strand that lies upon another for no reason; empty for none."""
    visits, signs = diagram.visits, diagram.signs
    for place, (here, after) in enumerate(pairwise(visits)):
        alike = diagram.over[place] == diagram.over[place + 1]
        apart = abs(diagram.partner(place) - diagram.partner(place + 1))
        if alike and apart == 1 and signs[here] != signs[after]:
            return frozenset({here, after})
    return frozenset()
