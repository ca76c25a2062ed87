"""What a model says of every pair of objects, before anything is normalised.

Scores are kept apart from affinities: a model is asked once, and recipes are tried on its answers.
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict

from executive.core.errors import InputError
from executive.core.json_files import read_json
from executive.core.registry import closest
from perception.shelf.types import Floats

ScoreKind = Literal["log-probability", "cosine", "log-affinity"]


@dataclass(frozen=True, slots=True)
class Source:
    """Who scored the pairs.

    Attributes:
        model: Name of the model.
        version: Versions of the package that carries it and of what ran it.
        licence: Terms of the model.
        date: Day on which it was asked, ISO 8601.
    """

    model: str
    version: str
    licence: str
    date: str


class _ScoreFile(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")

    format: Literal[1]
    kind: ScoreKind
    model: str
    version: str
    licence: str
    date: str
    names: tuple[str, ...]
    prompts: tuple[str, ...]
    scores: tuple[tuple[tuple[float, ...], ...], ...]


@dataclass(frozen=True, slots=True, eq=False)
class PairScores:
    """Scores of all pairs of objects.

    Attributes:
        names: Names of the objects.
        prompts: What a language model was asked, `{X}` for the first object; one empty prompt
            where there is none.
        scores: Of B (last axis) after A, for each prompt, shape (prompts, N, N): natural
            logarithms of probabilities, cosines, or logarithms of affinities.
        kind: Which of them.
        source: Who gave them.
    """

    names: tuple[str, ...]
    prompts: tuple[str, ...]
    scores: Floats
    kind: ScoreKind
    source: Source

    def of_names(self, names: tuple[str, ...]) -> "PairScores":
        """Return the scores of some of the objects, in the order that is asked for.

        Raises:
            InputError: One of them has not been scored.
        """
        for name in names:
            if name not in self.names:
                known = closest(name, list(self.names))
                raise InputError(
                    f"scores of {self.source.model}: unknown object {name!r}; {known}; "
                    f"try: cellwright affinity build with a model that scores it"
                )
        picked = [self.names.index(name) for name in names]
        scores = self.scores[:, picked][:, :, picked]
        return PairScores(names, self.prompts, scores, self.kind, self.source)

    def save(self, path: Path) -> None:
        """Write the scores as JSON, rounded to four digits after the point."""
        content = {
            "format": 1,
            "kind": self.kind,
            "model": self.source.model,
            "version": self.source.version,
            "licence": self.source.licence,
            "date": self.source.date,
            "names": self.names,
            "prompts": self.prompts,
        }
        head = json.dumps(content, indent=1)[:-2]
        rows = ",\n".join(
            f"  [{', '.join(json.dumps(row) for row in np.round(layer, 4).tolist())}]"
            for layer in self.scores
        )
        path.write_text(f'{head},\n "scores": [\n{rows}\n ]\n}}\n', encoding="utf-8")


def load_scores(path: Path) -> PairScores:
    """Read scores that `PairScores.save` has written.

    Raises:
        InputError: The file cannot be used.
    """
    document = read_json(path, _ScoreFile, "scores of pairs")
    source = Source(document.model, document.version, document.licence, document.date)
    count, layers = len(document.names), len(document.prompts)
    sides = {len(row) for layer in document.scores for row in layer}
    sides |= {len(layer) for layer in document.scores}
    if sides != {count} or len(document.scores) != layers:
        raise InputError(
            f"{path}: scores: expected {layers} x {count} x {count} values, for {layers} prompts "
            f"and {count} names"
        )
    scores = np.array(document.scores, dtype=np.float64)
    return PairScores(document.names, document.prompts, scores, document.kind, source)


def check_names(names: tuple[str, ...]) -> None:
    """Refuse names that cannot be scored.

    Raises:
        InputError: There are fewer than two, one is empty, or one comes twice.
    """
    if len(names) < 2:
        raise InputError(f"objects: got {len(names)}; expected at least 2 names")
    if any(not name.strip() for name in names):
        raise InputError("objects: got an empty name; expected words")
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise InputError(f"objects: got {twice[0]!r} twice; expected different names")
