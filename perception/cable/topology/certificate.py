"""Certificates: what lets anybody check a verdict without trusting who gave it.

An unknot is proved by moves that end without crossings. A knot is proved by a colouring:
arcs get colours from the numbers modulo a prime p, such that at every crossing the colour
that leaves below is t times the one that enters below, plus 1 - t times the one on top. An
unknot has only colourings with one colour, and moves keep how many colourings there are (for
t = -1: R. H. Fox 1962; in general: colourings by Alexander quandles, D. Joyce 1982). A knot that
no colouring tells is proved by its Jones polynomial, which anybody can add up anew.
"""

from dataclasses import dataclass
from functools import cache

from perception.cable.topology.alexander import alexander_polynomial
from perception.cable.topology.diagram import Diagram
from perception.cable.topology.jones import jones_polynomial
from perception.cable.topology.moves import Step
from perception.cable.topology.polynomial import Laurent
from perception.cable.topology.simplify import reached
from perception.cable.topology.verdict import Knottedness, Proof, Verdict, judge, reduction

# Roots of the polynomial are looked for modulo primes up to here.
LARGEST_PRIME = 400


@dataclass(frozen=True, slots=True)
class Colouring:
    """Colours of a diagram's arcs, which are numbered from the first visit on.

    Attributes:
        prime: Colours are numbers modulo this.
        t: What colours are multiplied by when they pass below.
        colours: One an arc, not all alike; an arc ends where it passes below.
    """

    prime: int
    t: int
    colours: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Certificate:
    """The proof of a verdict.

    Attributes:
        steps: Moves, in order.
        colouring: Colours of the diagram they lead to; None where it has no crossings, or where
            only the Jones polynomial proves a knot.
        jones: The Jones polynomial of that diagram where it is the proof.
    """

    steps: tuple[Step, ...]
    colouring: Colouring | None = None
    jones: Laurent | None = None


def certify(diagram: Diagram) -> tuple[Verdict, Certificate | None]:
    """Say whether a closed diagram is knotted, with a proof that can be replayed.

    Returns:
        The verdict, and its certificate; None where it is undecided, or proved by knot tables.
    """
    if not diagram.is_planar():
        return judge(diagram, None), None
    steps = reduction(diagram)
    reduced = reached(diagram, steps)
    verdict = judge(diagram, reduced)
    if not reduced.visits:
        return verdict, Certificate(steps)
    if verdict.proof is Proof.JONES:
        return verdict, Certificate(steps, jones=jones_polynomial(reduced))
    colouring = find_colouring(reduced) if verdict.state is Knottedness.KNOTTED else None
    return verdict, None if colouring is None else Certificate(steps, colouring)


def find_colouring(diagram: Diagram) -> Colouring | None:
    """Return a colouring with more than one colour; None where no small prime has one."""
    polynomial = alexander_polynomial(diagram)
    for prime in _primes(LARGEST_PRIME):
        # Minus one first: with it the knot's sides do not matter.
        for t in (prime - 1, *range(2, prime - 1)):
            if sum(c * pow(t, k, prime) for k, c in enumerate(polynomial)) % prime == 0:
                return Colouring(prime, t, _colours(diagram, prime, t))
    return None


@cache
def _primes(largest: int) -> list[int]:
    return [n for n in range(3, largest) if all(n % k for k in range(2, int(n**0.5) + 1))]


def _colours(diagram: Diagram, prime: int, t: int) -> tuple[int, ...]:
    """Solve the equations of all crossings with the first arc's colour 0."""
    rows, pivots = _reduced(_equations(diagram, prime, t), prime)
    free = next(k for k in range(1, len(diagram)) if k not in pivots)
    colours = [0] * len(diagram)
    colours[free] = 1
    for row, pivot in zip(rows, pivots, strict=True):
        colours[pivot] = -row[free] % prime
    return tuple(colours)


def _equations(diagram: Diagram, prime: int, t: int) -> list[list[int]]:
    """Return one row a crossing; its product with the colours is 0."""
    size, arc = len(diagram), 0
    rows = [[0] * size for _ in range(size)]
    for crossing, on_top in zip(diagram.visits, diagram.over, strict=True):
        row = rows[crossing]
        if on_top:
            row[arc] += 1 - t
            continue
        before, after = (t, -1) if diagram.signs[crossing] > 0 else (-1, t)
        row[arc] += before
        row[(arc + 1) % size] += after
        arc = (arc + 1) % size
    return [[value % prime for value in row] for row in rows]


def _reduced(rows: list[list[int]], prime: int) -> tuple[list[list[int]], list[int]]:
    """Return independent rows, each with a 1 where the others have 0, and where; not column 0."""
    done: list[list[int]] = []
    pivots: list[int] = []
    for row in rows:
        for kept, pivot in zip(done, pivots, strict=True):
            row = [(a - row[pivot] * b) % prime for a, b in zip(row, kept, strict=True)]
        pivot = next((k for k in range(1, len(row)) if row[k]), 0)
        if not pivot:
            continue
        inverse = pow(row[pivot], -1, prime)
        row = [value * inverse % prime for value in row]
        done = [
            [(a - kept[pivot] * b) % prime for a, b in zip(kept, row, strict=True)] for kept in done
        ]
        done.append(row)
        pivots.append(pivot)
    return done, pivots
