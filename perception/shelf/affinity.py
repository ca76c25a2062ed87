"""Affinities: how likely one object is the nearest neighbour of another (thesis, section 6.1).

A matrix comes from a file; who made it, and how, is written there too.
"""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict

from executive.core.errors import InputError
from executive.core.json_files import read_json
from executive.core.registry import closest
from perception.shelf.types import Floats

# Probabilities below are as good as none; their logarithms must stay finite.
LEAST = 1e-12


class _AffinityFile(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")

    format: Literal[1]
    model: str
    prompt: str
    version: str
    date: str
    licence: str = ""
    names: tuple[str, ...]
    rows: tuple[tuple[float, ...], ...]


@dataclass(frozen=True, slots=True)
class Origin:
    """Where affinities come from.

    Attributes:
        model: What scored the pairs.
        prompt: What it was asked; empty where there is no prompt.
        version: Version of the model or of the recipe.
        date: Day on which it was done, ISO 8601.
        licence: Terms of the models.
    """

    model: str
    prompt: str = ""
    version: str = ""
    date: str = ""
    licence: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class AffinityMatrix:
    """Affinities between all objects of a domain.

    Attributes:
        names: Names of the objects.
        rows: Row of A, column of B: P(B is nearest to A); rows add up to 1 and the diagonal is
            zero. Shape (N, N).
        origin: Where they come from.
    """

    names: tuple[str, ...]
    rows: Floats
    origin: Origin

    def tempered(self, temperature: float) -> "AffinityMatrix":
        """Return rows proportional to exp(log M / temperature) (thesis, section 6.1).

        Args:
            temperature: 1 changes nothing, larger ones make rows more even; must be positive.

        Raises:
            InputError: It is not.
        """
        if not temperature > 0.0:
            raise InputError(f"affinity: temperature: got {temperature:g}; expected more than 0")
        return replace(self, rows=_tempered(self.rows, temperature))

    def mixed(self, share: float) -> "AffinityMatrix":
        """Return `share` of these affinities and for the rest even ones.

        Even affinities are those of a shelf in no order.

        Args:
            share: In [0, 1].
        """
        return replace(self, rows=share * self.rows + (1.0 - share) * even_rows(len(self.names)))

    def row(self, name: str) -> Floats:
        """Return the affinities of one object to all, shape (N,).

        Raises:
            InputError: The matrix does not know it.
        """
        return self.rows[self.index(name)]

    def index(self, name: str) -> int:
        """Return the number of an object.

        Raises:
            InputError: The matrix does not know it.
        """
        if name not in self.names:
            known = closest(name, list(self.names))
            raise InputError(f"affinity: unknown object {name!r}; {known}")
        return self.names.index(name)

    def save(self, path: Path) -> None:
        """Write the matrix as JSON, rounded to nine digits."""
        rows = tuple(tuple(float(f"{value:.9g}") for value in row) for row in self.rows)
        origin = self.origin
        document = _AffinityFile(
            format=1, model=origin.model, prompt=origin.prompt, version=origin.version,
            date=origin.date, licence=origin.licence, names=self.names, rows=rows,
        )  # fmt: skip
        path.write_text(document.model_dump_json(indent=1) + "\n", encoding="utf-8")


def affinity_from_scores(names: tuple[str, ...], scores: Floats, origin: Origin) -> AffinityMatrix:
    """Normalise raw scores (thesis, section 6.1).

    The diagonal goes first and not last: a model that repeats what it was asked would else take
    most of every column's sum. Then columns are divided by their sums, since frequent words are not
    frequent neighbours, and rows are.

    Args:
        names: Names of the objects.
        scores: Score of column B as neighbour of row A, not negative, shape (N, N).
        origin: Where they come from.

    Raises:
        InputError: The scores cannot be used.
    """
    _check(names, scores, "affinity")
    free = np.where(np.eye(len(names), dtype=bool), 0.0, np.maximum(scores, LEAST))
    columns = free / free.sum(axis=0, keepdims=True)
    return AffinityMatrix(names, columns / columns.sum(axis=1, keepdims=True), origin)


def load_affinity(path: Path) -> AffinityMatrix:
    """Read a matrix that `AffinityMatrix.save` has written, or that somebody made.

    Rows need not add up to 1, and the diagonal is ignored.

    Raises:
        InputError: The file cannot be used.
    """
    document = read_json(path, _AffinityFile, "an affinity matrix")
    if len({len(row) for row in document.rows} | {len(document.names)}) != 1:
        raise InputError(f"{path}: rows: expected {len(document.names)} values in each row")
    rows = np.array(document.rows, dtype=np.float64)
    _check(document.names, rows, str(path))
    origin = Origin(
        document.model, document.prompt, document.version, document.date, document.licence
    )
    return AffinityMatrix(document.names, _tempered(rows, 1.0), origin)


def even_rows(count: int) -> Floats:
    """Return affinities without any preference, shape (count, count)."""
    return (1.0 - np.eye(count)) / (count - 1)


def _tempered(rows: Floats, temperature: float) -> Floats:
    logs = np.log(np.maximum(rows, LEAST)) / temperature
    np.fill_diagonal(logs, -np.inf)
    powers = np.exp(logs - logs.max(axis=1, keepdims=True))
    return powers / powers.sum(axis=1, keepdims=True)


def _check(names: tuple[str, ...], scores: Floats, where: str) -> None:
    count = len(names)
    if scores.shape != (count, count) or count < 2:
        raise InputError(
            f"{where}: got a matrix of shape {scores.shape} for {count} names; expected "
            f"({count}, {count}) and at least 2 names"
        )
    if len(set(names)) != count:
        raise InputError(f"{where}: names: got one twice; expected different names")
    if not np.isfinite(scores).all() or (scores < 0.0).any():
        raise InputError(f"{where}: scores: expected finite values that are not negative")
