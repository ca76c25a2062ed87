"""Is it knotted? Answered with a proof, or not at all."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from perception.cable.topology.alexander import alexander_polynomial, determinant
from perception.cable.topology.curve import close_over, curve_crossings
from perception.cable.topology.diagram import Diagram
from perception.cable.topology.jones import jones_polynomial
from perception.cable.topology.moves import Step
from perception.cable.topology.polynomial import ONE
from perception.cable.topology.simplify import reached, search, shortening

# The smallest knots with a trivial Alexander polynomial are the Kinoshita-Terasaka and
# Conway knots with 11 crossings (tables of knots to 10 crossings: D. Rolfsen 1976).
ALEXANDER_DECIDES_CROSSINGS = 10
# No other knot with so few crossings has the unknot's Jones polynomial (R. E. Tuzun and A. S.
# Sikora, "Verification of the Jones unknot conjecture up to 24 crossings", 2021).
JONES_DECIDES_CROSSINGS = 24
# Diagrams of equal size that are looked at: what is proved to be knotted need not get smaller.
STATES_OF_KNOTS = 12
STATES_OF_OTHERS = 400


class Knottedness(StrEnum):
    """What is known about a closed curve."""

    UNKNOT = "unknot"
    KNOTTED = "knotted"
    UNDECIDED = "undecided"


class Proof(StrEnum):
    """Why it is known."""

    MOVES = "moves"
    ALEXANDER = "alexander polynomial"
    JONES = "jones polynomial"
    TABLES = "polynomials and knot tables"
    NONE = "none"


@dataclass(frozen=True, slots=True)
class Verdict:
    """The answer for one curve.

    Attributes:
        state: Knotted or not.
        proof: What proves it.
        crossings: Crossings of the curve as it was seen, without its closure.
        reduced_crossings: Crossings that were left after simplifying.
    """

    state: Knottedness
    proof: Proof
    crossings: int
    reduced_crossings: int


def classify_curve(nodes_m: NDArray[np.float64]) -> Verdict:
    """Say whether a cable is knotted when its ends are joined over everything.

    Args:
        nodes_m: Ordered centre line, shape (N, 3), z up; it is viewed from above.
    """
    strand = curve_crossings(np.asarray(nodes_m, dtype=float))
    return classify_diagram(close_over(strand), len(strand.crossings))


def classify_diagram(diagram: Diagram, crossings: int | None = None) -> Verdict:
    """Say whether a closed diagram is knotted.

    Args:
        diagram: The diagram; one that cannot be drawn in the plane stays undecided.
        crossings: How many crossings to report as seen; the diagram's own by default.
    """
    reduced = reached(diagram, reduction(diagram)) if diagram.is_planar() else None
    return judge(diagram, reduced, crossings)


def reduction(diagram: Diagram) -> tuple[Step, ...]:
    """Return moves to a diagram with few crossings.

    What is known to be knotted after the moves that save crossings is searched only briefly.
    """
    steps = shortening(diagram)
    shortened = reached(diagram, steps)
    if not shortened.visits:
        return tuple(steps)
    knotted = knot_proof(shortened) is not None
    return (*steps, *search(shortened, STATES_OF_KNOTS if knotted else STATES_OF_OTHERS))


def judge(diagram: Diagram, reduced: Diagram | None, crossings: int | None = None) -> Verdict:
    """Return the verdict on a diagram from what it was reduced to, None for not at all."""
    seen = len(diagram) if crossings is None else crossings
    if reduced is None:
        return Verdict(Knottedness.UNDECIDED, Proof.NONE, seen, len(diagram))
    state, proof = _decide(reduced)
    return Verdict(state, proof, seen, len(reduced))


def knot_proof(diagram: Diagram) -> Proof | None:
    """Return which polynomial proves that a diagram is knotted; None where neither does."""
    if determinant(diagram) != 1 or alexander_polynomial(diagram) != (1,):
        return Proof.ALEXANDER
    if len(diagram) > ALEXANDER_DECIDES_CROSSINGS and jones_polynomial(diagram) != ONE:
        return Proof.JONES
    return None


def _decide(reduced: Diagram) -> tuple[Knottedness, Proof]:
    if not reduced.visits:
        return Knottedness.UNKNOT, Proof.MOVES
    proof = knot_proof(reduced)
    if proof is not None:
        return Knottedness.KNOTTED, proof
    if len(reduced) <= JONES_DECIDES_CROSSINGS:
        return Knottedness.UNKNOT, Proof.TABLES
    return Knottedness.UNDECIDED, Proof.NONE
