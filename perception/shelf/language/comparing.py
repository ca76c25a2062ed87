"""Affinity matrices beside a taxonomy, all in one form."""

from dataclasses import asdict, dataclass

import numpy as np

from executive.core.errors import InputError
from perception.shelf.affinity import AffinityMatrix, Origin, even_rows
from perception.shelf.affinity_scoring import (
    divergence_of_neighbours,
    divergence_with_diagonal,
    nearest_in_category,
)
from perception.shelf.language.recipes import RECIPES, Recipe, affinity_of, with_diagonal
from perception.shelf.language.scores import PairScores
from perception.shelf.language.stored import stored_models, stored_scores
from perception.shelf.types import Floats

EVEN = "uniform"


@dataclass(frozen=True, slots=True)
class Agreement:
    """How well one matrix agrees with a taxonomy.

    Attributes:
        name: Of the matrix.
        with_diagonal: Mean divergence of rows [bits], as the thesis's Table 7.1 has it.
        of_neighbours: The same without diagonals and without objects that are alone.
        nearest: Share of objects whose likeliest neighbour shares their category.
    """

    name: str
    with_diagonal: float
    of_neighbours: float
    nearest: float

    def document(self) -> dict[str, str | float]:
        """Return it for JSON."""
        return asdict(self)


def agreement(
    name: str, matrix: AffinityMatrix, names: tuple[str, ...], truth: Floats
) -> Agreement:
    """Hold a matrix against a taxonomy.

    Args:
        name: What to call it.
        matrix: The matrix; it may hold more objects than the taxonomy.
        names: The taxonomy's objects.
        truth: Its affinities, with their diagonal, shape (N, N).

    Raises:
        InputError: The matrix does not know one of the objects.
    """
    try:
        picked = [matrix.index(thing) for thing in names]
    except InputError as error:
        raise InputError(f"{name}: {error}") from None
    rows = np.array(matrix.rows[np.ix_(picked, picked)])
    return Agreement(
        name,
        divergence_with_diagonal(with_diagonal(rows), truth),
        divergence_of_neighbours(rows, truth),
        float(nearest_in_category(rows, truth).mean()),
    )


def stored_agreements(names: tuple[str, ...], domain: str, truth: Floats) -> list[Agreement]:
    """Hold even affinities and everything that is stored for a domain against its taxonomy."""
    even = AffinityMatrix(names, even_rows(len(names)), Origin(EVEN))
    rows = [agreement(EVEN, even, names, truth)]
    for label, matrix in stored_matrices(domain):
        rows.append(agreement(label, matrix, names, truth))
    return rows


def stored_matrices(domain: str) -> list[tuple[str, AffinityMatrix]]:
    """Return what can be made of the stored scores of a domain, by `MODELS/RECIPE`."""
    return [
        (name, affinity_of(parts, recipe)) for name, (parts, recipe) in stored_ways(domain).items()
    ]


def stored_ways(domain: str) -> dict[str, tuple[list[PairScores], Recipe]]:
    """Return which stored scores of a domain go together, and how, by `MODELS/RECIPE`."""
    scores = {model: stored_scores(domain, model) for model in stored_models().get(domain, ())}
    embedders = [model for model, part in scores.items() if part.kind == "cosine"]
    symmetric = RECIPES["symmetric"]
    ways = {model: ([scores[model]], symmetric) for model in embedders}
    for model in scores.keys() - {*embedders}:
        ways |= {f"{model}/{name}": ([scores[model]], recipe) for name, recipe in RECIPES.items()}
        ways |= {
            f"{model}+{other}": ([scores[model], scores[other]], symmetric) for other in embedders
        }
    return dict(sorted(ways.items()))
