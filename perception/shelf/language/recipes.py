"""From scores to affinities: which scores, and how they are put together.

All recipes are written down before any of them is held against a taxonomy, and none has a number
that was fitted to one:

- The diagonal goes first: a model that repeats what it was asked would take most of every column.
- Columns are divided by their sums (thesis, section 6.1).
- Prompts are averaged as logarithms, equally.
- "A beside B" and "B beside A" say the same of a shelf, so both logarithms are averaged.
- Cosines become logarithms by the temperature that the embedding was trained with: the factor 20 of
  the ranking loss of sentence-transformers.
- A language model and an embedding are averaged as logarithms, equally.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from types import MappingProxyType
from typing import Final

import numpy as np

from executive.core.errors import InputError
from perception.shelf.affinity import AffinityMatrix, Origin
from perception.shelf.language.prompts import THESIS_PROMPT
from perception.shelf.language.scores import PairScores
from perception.shelf.types import Floats

COSINE_TEMPERATURE = 0.05


class Diagonal(Enum):
    """What becomes of scores of an object beside itself."""

    NONE = "none"
    OWN = "own"


@dataclass(frozen=True, slots=True)
class Recipe:
    """How scores become affinities.

    Attributes:
        about: What it does.
        prompts: Prompts whose scores are used; None for all.
        symmetric: Whether both directions of a pair are averaged.
    """

    about: str
    prompts: tuple[str, ...] | None = None
    symmetric: bool = True


RECIPES: Final[Mapping[str, Recipe]] = MappingProxyType(
    {
        "thesis": Recipe("the thesis's prompt and normalisation", (THESIS_PROMPT,), False),
        "prompts": Recipe("all prompts, averaged", None, False),
        "symmetric": Recipe("all prompts, and both directions of a pair, averaged"),
    }
)


def affinity_of(parts: Sequence[PairScores], recipe: Recipe) -> AffinityMatrix:
    """Put scores of the same objects together.

    Args:
        parts: Scores of at least one model, in the same names.
        recipe: What to do with them.

    Raises:
        InputError: There are none, they are of different objects, or a prompt is missing.
    """
    if not parts:
        raise InputError("affinity: got no scores; expected those of one model at least")
    names = parts[0].names
    if any(part.names != names for part in parts):
        raise InputError("affinity: got scores of different objects; expected the same ones")
    rows = _rows(parts, recipe, Diagonal.NONE)
    return AffinityMatrix(names, rows, _origin(parts, recipe))


def rows_with_own_diagonal(parts: Sequence[PairScores], recipe: Recipe) -> Floats:
    """Return affinities where models' scores of an object beside itself are kept, shape (N, N).

    The thesis seems to have held such matrices against the taxonomy (section 7.1). They are for
    that comparison alone: how a model repeats words says nothing of shelves.

    Args:
        parts: Scores of at least one model, in the same names.
        recipe: What to do with them.
    """
    return _rows(parts, recipe, Diagonal.OWN)


def with_diagonal(rows: Floats) -> Floats:
    """Return affinities with a diagonal, for comparisons that want one, shape (N, N).

    An object goes with itself as well as with what it goes with best.

    Args:
        rows: Affinities without a diagonal, shape (N, N).
    """
    filled = np.array(rows)
    np.fill_diagonal(filled, 0.0)
    np.fill_diagonal(filled, filled.max(axis=1))
    whole: Floats = filled / filled.sum(axis=1, keepdims=True)
    return whole


def _rows(parts: Sequence[PairScores], recipe: Recipe, diagonal: Diagonal) -> Floats:
    logs = np.mean([_log_affinities(part, recipe, diagonal) for part in parts], axis=0)
    rows: Floats = np.exp(logs - np.logaddexp.reduce(logs, axis=1, keepdims=True))
    return rows


def _log_affinities(part: PairScores, recipe: Recipe, diagonal: Diagonal) -> Floats:
    """Return what one model says, as logarithms."""
    if part.kind == "cosine":
        logs = part.scores.mean(axis=0) / COSINE_TEMPERATURE
        return _normal(logs, diagonal, columns=False)
    picked = part.scores if part.kind == "log-affinity" else part.scores[_layers(part, recipe)]
    logs = _normal(picked.mean(axis=0), diagonal, columns=True)
    if not recipe.symmetric:
        return logs
    return _normal(0.5 * (logs + logs.T), diagonal, columns=False)


def _layers(part: PairScores, recipe: Recipe) -> list[int]:
    if recipe.prompts is None:
        return [*range(len(part.prompts))]
    missing = [prompt for prompt in recipe.prompts if prompt not in part.prompts]
    if missing:
        raise InputError(
            f"affinity: {part.source.model} was not asked {missing[0]!r}; "
            f"got scores of: {'; '.join(part.prompts)}"
        )
    return [part.prompts.index(prompt) for prompt in recipe.prompts]


def _normal(logs: Floats, diagonal: Diagonal, *, columns: bool) -> Floats:
    """Return logarithms of rows that add up to 1, after columns where that is asked for."""
    free = np.array(logs)
    if diagonal is Diagonal.NONE:
        np.fill_diagonal(free, -np.inf)
    if columns:
        free = free - np.logaddexp.reduce(free, axis=0, keepdims=True)
    normal: Floats = free - np.logaddexp.reduce(free, axis=1, keepdims=True)
    return normal


def _origin(parts: Sequence[PairScores], recipe: Recipe) -> Origin:
    prompts = dict.fromkeys(
        prompt
        for part in parts
        for prompt in part.prompts
        if prompt and (recipe.prompts is None or prompt in recipe.prompts)
    )
    sources = [part.source for part in parts]
    return Origin(
        " + ".join(source.model for source in sources),
        " | ".join(prompts),
        "; ".join(source.version for source in sources),
        max(source.date for source in sources),
        "; ".join(dict.fromkeys(source.licence for source in sources if source.licence)),
    )
