"""Affinities beside the taxonomy, which none of them was made from (thesis, Table 7.1).

`A` is the thesis's figure: divergence in bits, diagonals kept, objects without a category on
themselves. Where a matrix has no diagonal, an object gets as much weight on itself as on its best
neighbour; `A own` keeps what the models themselves say of an object beside itself, as the thesis
seems to. `D` leaves out diagonals and objects that are alone in their category. The recipes were
fixed on the pharmacy; kitchen and office are asked the same way. Stored scores are used, so no
model runs; `cellwright affinity build` asks the models anew.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np

from benchmarks.harness import Row, mean, share
from perception.shelf.affinity import AffinityMatrix, Origin, even_rows
from perception.shelf.affinity_scoring import (
    nearest_in_category,
    neighbour_divergences,
    row_divergences,
)
from perception.shelf.language.comparing import EVEN, stored_matrices, stored_ways
from perception.shelf.language.recipes import rows_with_own_diagonal, with_diagonal
from perception.shelf.language.stored import BEST_MODELS, DEFAULT_MODELS, stored_affinity
from perception.shelf.types import Floats
from simulation.shelf.taxonomy import Domain, shipped_domain, taxonomy_affinity

FIRST: Final = "pharmacy"
OTHERS: Final = ("kitchen", "office")
GOAL: Final = "<= 0.30"


def run(quick: bool, seed: int) -> Sequence[Row]:  # noqa: ARG001 - there is no chance in it
    """Return the rows of all domains; a quick run has the first alone."""
    rows = _stable_rows()
    for name in (FIRST,) if quick else (FIRST, *OTHERS):
        domain = shipped_domain(name)
        truth = taxonomy_affinity(domain)
        for label, matrix in _matrices(domain):
            rows += _rows(f"{name}/{label}", matrix, truth)
        for label, (parts, recipe) in stored_ways(name).items():
            own = row_divergences(rows_with_own_diagonal(parts, recipe), truth)
            rows.append(mean(f"A own {name}/{label}", own.tolist(), "bit"))
    return rows


def _stable_rows() -> list[Row]:
    """Return the three rows that other checks ask for by name."""
    domain = shipped_domain(FIRST)
    truth = taxonomy_affinity(domain)
    matrices = {
        "jsd_uniform": (_even(domain), "= 0.65"),
        "jsd_default": (stored_affinity(FIRST, DEFAULT_MODELS), GOAL),
        "jsd_best_offline": (stored_affinity(FIRST, BEST_MODELS), GOAL),
    }
    return [
        mean(name, row_divergences(with_diagonal(matrix.rows), truth).tolist(), "bit", goal)
        for name, (matrix, goal) in matrices.items()
    ]


def _even(domain: Domain) -> AffinityMatrix:
    return AffinityMatrix(domain.names, even_rows(len(domain.names)), Origin(EVEN))


def _matrices(domain: Domain) -> list[tuple[str, AffinityMatrix]]:
    return [(EVEN, _even(domain)), *stored_matrices(domain.name)]


def _rows(name: str, matrix: AffinityMatrix, truth: Floats) -> list[Row]:
    shared = nearest_in_category(matrix.rows, truth)
    return [
        mean(f"A {name}", row_divergences(with_diagonal(matrix.rows), truth).tolist(), "bit"),
        mean(f"D {name}", neighbour_divergences(matrix.rows, truth).tolist(), "bit"),
        share(f"nearest {name}", int(np.count_nonzero(shared)), len(shared)),
    ]
