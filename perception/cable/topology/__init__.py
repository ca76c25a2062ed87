"""Knot theory of cables: diagrams, moves, invariants, and verdicts that can be proved."""

from perception.cable.topology.curve import Strand, StrandCrossing, close_over, curve_crossings
from perception.cable.topology.diagram import Diagram
from perception.cable.topology.names import knot_type
from perception.cable.topology.verdict import (
    Knottedness,
    Proof,
    Verdict,
    classify_curve,
    classify_diagram,
)

__all__ = [
    "Diagram",
    "Knottedness",
    "Proof",
    "Strand",
    "StrandCrossing",
    "Verdict",
    "classify_curve",
    "classify_diagram",
    "close_over",
    "curve_crossings",
    "knot_type",
]
