"""Providers of scores: everything that can say how well two objects go together.

There is one protocol. Behind it stand language models that are asked with prompts, embeddings,
and files.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np

from executive.core.errors import InputError
from perception.shelf.affinity import LEAST, load_affinity
from perception.shelf.language.prompts import PROMPTS, fill
from perception.shelf.language.scores import PairScores, Source, check_names
from perception.shelf.types import Floats

Progress = Callable[[int, int], None]


class Provider(Protocol):
    """Whatever scores pairs of objects."""

    def score(self, names: tuple[str, ...], progress: Progress | None = None) -> PairScores:
        """Score every object as the neighbour of every other.

        Args:
            names: Names of the objects.
            progress: Called with how many rows are done, of how many.

        Raises:
            InputError: The names, the model or its address cannot be used.
        """
        ...


class LanguageModel(Protocol):
    """A model that gives probabilities of continuations."""

    @property
    def source(self) -> Source:
        """Which model that is."""
        ...

    def log_probabilities(self, prompt: str, words: Sequence[str]) -> Floats:
        """Return log P(word | prompt) of whole words, natural, shape (words,)."""
        ...


class Embedder(Protocol):
    """A model that turns words into vectors."""

    @property
    def source(self) -> Source:
        """Which model that is."""
        ...

    def embed(self, words: Sequence[str]) -> Floats:
        """Return vectors of length 1, shape (words, D)."""
        ...


@dataclass(frozen=True, slots=True)
class PromptedProvider:
    """Asks a language model (thesis, section 6.1).

    Attributes:
        model: Whom to ask.
        prompts: What to ask, `{X}` for the object.
    """

    model: LanguageModel
    prompts: tuple[str, ...] = PROMPTS

    def score(self, names: tuple[str, ...], progress: Progress | None = None) -> PairScores:
        """Return log-probabilities; see `Provider.score`."""
        check_names(names)
        scores = np.empty((len(self.prompts), len(names), len(names)))
        for layer, prompt in enumerate(self.prompts):
            for row, name in enumerate(names):
                scores[layer, row] = self.model.log_probabilities(fill(prompt, name), names)
                if progress is not None:
                    progress(layer * len(names) + row + 1, scores.shape[0] * len(names))
        return PairScores(names, self.prompts, scores, "log-probability", self.model.source)


@dataclass(frozen=True, slots=True)
class EmbeddingProvider:
    """Compares the vectors of names (thesis, section 7.1).

    Attributes:
        model: What gives the vectors.
    """

    model: Embedder

    def score(self, names: tuple[str, ...], progress: Progress | None = None) -> PairScores:
        """Return cosines; see `Provider.score`."""
        check_names(names)
        vectors = self.model.embed(names)
        if progress is not None:
            progress(len(names), len(names))
        return PairScores(names, ("",), (vectors @ vectors.T)[None], "cosine", self.model.source)


@dataclass(frozen=True, slots=True)
class FileProvider:
    """Takes the affinities of a file for scores.

    Attributes:
        path: A matrix as `AffinityMatrix.save` writes it.
    """

    path: Path

    def score(self, names: tuple[str, ...], progress: Progress | None = None) -> PairScores:
        """Return logarithms of affinities; see `Provider.score`."""
        check_names(names)
        matrix = load_affinity(self.path)
        try:
            picked = [matrix.index(name) for name in names]
        except InputError as error:
            raise InputError(f"{self.path}: {error}") from None
        logs = np.log(np.maximum(matrix.rows[np.ix_(picked, picked)], LEAST))
        if progress is not None:
            progress(len(names), len(names))
        source = Source(matrix.origin.model, matrix.origin.version, "", matrix.origin.date)
        return PairScores(names, (matrix.origin.prompt,), logs[None], "log-affinity", source)
