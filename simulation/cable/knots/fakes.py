"""Fake knots: the curve of a knot with over and under so that it is none."""

from collections.abc import Iterator, Sequence
from functools import cache
from itertools import combinations

from perception.cable.topology import (
    Diagram,
    Knottedness,
    Proof,
    StrandCrossing,
    classify_diagram,
    close_over,
)
from perception.cable.topology.alexander import determinant
from simulation.cable.knots.template import KnotTemplate

# How many fakes a template has at most.
MOST = 12


@cache
def fake_overs(template: KnotTemplate) -> tuple[tuple[bool, ...], ...]:
    """Return choices of over and under along a template's curve that are proved no knot.

    The proof is a list of moves that undo all crossings (`classify_diagram`). A curve that is
    just laid down in order, each strand over all that lies there, is left out: so each of
    these goes both over and under as if it were tied. Those that differ least from the knot,
    or from its mirror image, come first.

    Returns:
        For each fake, whether the curve runs on top at each visit.
    """
    strand = template.strand()
    true, found = close_over(strand), []
    for swapped in _subsets(template.crossings):
        first_over = [c.first_over != (k in swapped) for k, c in enumerate(strand.crossings)]
        layered = len(set(first_over)) == 1
        if not layered and _is_proved_unknot(true.swapped(swapped)):
            found.append(_along(strand.crossings, first_over))
        if len(found) == MOST:
            break
    return tuple(found)


def _subsets(crossings: int) -> Iterator[frozenset[int]]:
    """Yield sets of crossings, by how few there are in them or left out of them."""
    everything = frozenset(range(crossings))
    for count in range(1, crossings // 2 + 1):
        for some in combinations(range(crossings), count):
            yield frozenset(some)
            if 2 * count < crossings:
                yield everything - frozenset(some)


def _along(crossings: Sequence[StrandCrossing], first_over: Sequence[bool]) -> tuple[bool, ...]:
    """Return over and under at each visit, in the order of the curve."""
    visits = [
        visit
        for crossing, over in zip(crossings, first_over, strict=True)
        for visit in ((crossing.first, over), (crossing.second, not over))
    ]
    return tuple(over for _, over in sorted(visits))


def _is_proved_unknot(diagram: Diagram) -> bool:
    if determinant(diagram) != 1:
        return False
    verdict = classify_diagram(diagram)
    return verdict.state is Knottedness.UNKNOT and verdict.proof is Proof.MOVES
