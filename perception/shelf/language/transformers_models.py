"""Models of the transformers library, from local files alone: causal ones and sentence embedders.

The library and PyTorch are imported when a model is made; nothing is ever looked for on a hub.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np

from executive.core.errors import InputError
from perception.shelf.language.scores import Source
from perception.shelf.types import Floats

INSTALL = "pip install 'cellwright[learn,language]'"


@dataclass(frozen=True, slots=True)
class ModelFiles:
    """Where a model lies.

    Attributes:
        folder: A folder in the form of transformers, or one that holds a GGUF file.
        gguf: Name of that GGUF file; None for the form of transformers.
    """

    folder: Path
    gguf: str | None = None

    @property
    def where(self) -> Path:
        """The file, or the folder."""
        return self.folder / self.gguf if self.gguf else self.folder

    def load(self, kind: str) -> Any:
        """Return what a class of transformers makes of the files.

        Args:
            kind: Name of the class, `AutoTokenizer` for one.

        Raises:
            InputError: The library is not there, or it cannot make use of the files.
        """
        transformers = _library()
        options: dict[str, Any] = {"local_files_only": True}
        if self.gguf is not None:
            options["gguf_file"] = self.gguf
        if kind != "AutoTokenizer":
            options["dtype"] = "float32"
        try:
            return getattr(transformers, kind).from_pretrained(str(self.folder), **options)
        except (OSError, ValueError, KeyError, ImportError, RuntimeError) as error:
            first = str(error).strip().splitlines()[0]
            raise InputError(
                f"{self.where}: not a model that transformers {transformers.__version__} loads: "
                f"{first}; expected a folder with config.json and weights, or a .gguf file"
            ) from error


class CausalModel:
    """A causal language model, run by PyTorch on the processor."""

    def __init__(self, files: ModelFiles, source: Source) -> None:
        """Load the model.

        Args:
            files: Where it lies.
            source: What to call it.

        Raises:
            InputError: It cannot be loaded.
        """
        self.source = source
        self._tokenizer: Any = files.load("AutoTokenizer")
        self._model: Any = files.load("AutoModelForCausalLM").eval()

    def log_probabilities(self, prompt: str, words: Sequence[str]) -> Floats:
        """Return log P(word | prompt) of whole words, natural, shape (words,).

        What all texts begin with is run once, and its keys and values are kept for all words.
        """
        texts = [self._tokens(f"{prompt} {word}") for word in words]
        shared = _shared(texts, len(self._tokens(prompt)))
        rests = [text[shared:] for text in texts]
        with self._torch.inference_mode():
            start = self._tensor([texts[0][:shared]])
            out = self._model(start, use_cache=True, logits_to_keep=1)
            first = self._torch.log_softmax(out.logits[0, -1].double(), -1).numpy()
            totals = np.array([first[rest[0]] for rest in rests])
            if max(len(rest) for rest in rests) > 1:
                totals += self._rest(rests, out.past_key_values, shared)
        return totals

    @cached_property
    def _torch(self) -> Any:
        import torch

        return torch

    def _tokens(self, text: str) -> list[int]:
        return list(self._tokenizer(text)["input_ids"])

    def _tensor(self, rows: object) -> Any:
        return self._torch.tensor(rows, dtype=self._torch.long)

    def _rest(self, rests: list[list[int]], past: Any, shared: int) -> Floats:
        """Return log-probabilities of all tokens but the first of each word."""
        longest = max(len(rest) for rest in rests) - 1
        tokens = np.zeros((len(rests), longest), dtype=np.int64)
        mask = np.zeros((len(rests), shared + longest), dtype=np.int64)
        mask[:, :shared] = 1
        for row, rest in enumerate(rests):
            tokens[row, : len(rest) - 1] = rest[:-1]
            mask[row, shared : shared + len(rest) - 1] = 1
        past.batch_repeat_interleave(len(rests))
        hidden = self._model.get_decoder()(
            self._tensor(tokens), attention_mask=self._tensor(mask), past_key_values=past
        ).last_hidden_state
        return self._read(hidden, rests)

    def _read(self, hidden: Any, rests: list[list[int]]) -> Floats:
        # The output layer is by far the largest: it is asked only where a token follows.
        spots = [(row, at) for row, rest in enumerate(rests) for at in range(len(rest) - 1)]
        rows, places = (self._tensor(list(column)) for column in zip(*spots, strict=True))
        logits = self._model.get_output_embeddings()(hidden[rows, places])
        logs = self._torch.log_softmax(logits.double(), -1).numpy()
        totals = np.zeros(len(rests))
        for log, (row, at) in zip(logs, spots, strict=True):
            totals[row] += log[rests[row][at + 1]]
        return totals


class SentenceEmbedder:
    """An encoder whose mean over all tokens stands for a text, as sentence-transformers has it."""

    def __init__(self, files: ModelFiles, source: Source) -> None:
        """Load the model.

        Args:
            files: Where it lies.
            source: What to call it.

        Raises:
            InputError: It cannot be loaded.
        """
        self.source = source
        self._tokenizer: Any = files.load("AutoTokenizer")
        self._model: Any = files.load("AutoModel").eval()

    def embed(self, words: Sequence[str]) -> Floats:
        """Return vectors of length 1, shape (words, D)."""
        import torch

        with torch.inference_mode():
            batch = self._tokenizer(list(words), padding=True, return_tensors="pt")
            hidden = self._model(**batch).last_hidden_state.double().numpy()
        mask = batch["attention_mask"].numpy()[..., None].astype(np.float64)
        vectors = (hidden * mask).sum(axis=1) / mask.sum(axis=1)
        unit: Floats = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
        return unit


def library_versions() -> str:
    """Return what runs the models, for the record; empty where it is not installed."""
    try:
        return f"transformers {version('transformers')}, torch {version('torch')}"
    except PackageNotFoundError:
        return ""


def _shared(texts: list[list[int]], most: int) -> int:
    """Return how many tokens all texts begin with, leaving each at least one of its own."""
    length = min(most, *(len(text) - 1 for text in texts))
    same = (len({text[at] for text in texts}) == 1 for at in range(length))
    return next((at for at, alike in enumerate(same) if not alike), length)


def _library() -> Any:
    try:
        import torch
        import transformers
    except ImportError as error:
        raise InputError(
            f"language models: {error.name} is not installed; try: {INSTALL}"
        ) from error
    # More threads than one are slower on a busy machine, and sum in another order.
    torch.set_num_threads(1)
    transformers.utils.logging.disable_progress_bar()
    transformers.utils.logging.set_verbosity_error()
    return transformers
