"""How well affinities agree with a taxonomy, in the two ways of the page on affinities.

The thesis reports a Jensen-Shannon "distance" (section 7.1). Of the ways to read that, one gives
its figure for even affinities, 0.65: the divergence in bits, with the diagonal kept in both
matrices, where an object that shares its category with no other has all of its row on itself.
Mechanical search never asks for the diagonal, so the second way leaves it out, and objects that are
alone.
"""

import numpy as np

from perception.shelf.types import Bools, Floats


def divergence_bits(p: Floats, q: Floats) -> Floats:
    """Return the Jensen-Shannon divergence of distributions, in bits (J. Lin, 1991).

    Args:
        p: Distributions along the last axis.
        q: As many, of the same shape.

    Returns:
        One value in [0, 1] for each pair.
    """
    middle = 0.5 * (p + q)
    return 0.5 * (_relative_bits(p, middle) + _relative_bits(q, middle))


def divergence_with_diagonal(rows: Floats, truth: Floats) -> float:
    """Return the mean divergence of rows from a taxonomy as the thesis's Table 7.1 has it.

    Args:
        rows: Affinities with their diagonal, shape (N, N).
        truth: The taxonomy's, with theirs, shape (N, N).
    """
    return float(row_divergences(rows, truth).mean())


def divergence_of_neighbours(rows: Floats, truth: Floats) -> float:
    """Return the mean divergence of rows without diagonals, over objects that are not alone.

    Args:
        rows: Affinities; their diagonal is ignored; shape (N, N).
        truth: The taxonomy's, shape (N, N).
    """
    return float(neighbour_divergences(rows, truth).mean())


def row_divergences(rows: Floats, truth: Floats) -> Floats:
    """Return the divergence of every row, diagonals and all, shape (N,)."""
    return divergence_bits(rows, truth)


def neighbour_divergences(rows: Floats, truth: Floats) -> Floats:
    """Return the divergence of rows without diagonals, of the objects that are not alone."""
    kept = not_alone(truth)
    return divergence_bits(without_diagonal(rows)[kept], without_diagonal(truth[kept], kept))


def nearest_in_category(rows: Floats, truth: Floats) -> Bools:
    """Say of each object that is not alone whether its likeliest neighbour shares its category."""
    kept = not_alone(truth)
    best = without_diagonal(rows)[kept].argmax(axis=1)
    shared: Bools = truth[kept, best] > 0.0
    return shared


def not_alone(truth: Floats) -> Bools:
    """Say which objects share their category with another, shape (N,)."""
    alone: Bools = (truth > 0.0).sum(axis=1) > 1
    return alone


def without_diagonal(rows: Floats, picked: Bools | None = None) -> Floats:
    """Return rows with their diagonal at zero, adding up to 1 again.

    Args:
        rows: Shape (N, N), or (K, N) for the K rows that are picked.
        picked: Which of the N rows `rows` holds; None for all.
    """
    free = np.array(rows, dtype=np.float64)
    columns = np.arange(len(free)) if picked is None else np.flatnonzero(picked)
    free[np.arange(len(free)), columns] = 0.0
    return free / free.sum(axis=1, keepdims=True)


def _relative_bits(p: Floats, q: Floats) -> Floats:
    """Return the Kullback-Leibler divergence of p from q; nothing counts where p is zero."""
    there = p > 0.0
    ratio = np.divide(p, q, out=np.ones_like(p), where=there)
    bits: Floats = (p * np.log2(ratio)).sum(axis=-1)
    return bits
