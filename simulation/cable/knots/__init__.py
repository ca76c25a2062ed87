"""Knots as plane curves with over and under: the templates that configurations are laid from."""

from simulation.cable.knot_names import KNOT_NAMES, KnotName, PairName
from simulation.cable.knots.fakes import fake_overs
from simulation.cable.knots.gauss import gauss_code
from simulation.cable.knots.pairs import PAIRS, PairTemplate
from simulation.cable.knots.single import TEMPLATES
from simulation.cable.knots.splines import evenly, smooth
from simulation.cable.knots.template import KnotTemplate

__all__ = [
    "KNOT_NAMES",
    "PAIRS",
    "TEMPLATES",
    "KnotName",
    "KnotTemplate",
    "PairName",
    "PairTemplate",
    "evenly",
    "fake_overs",
    "gauss_code",
    "smooth",
]
