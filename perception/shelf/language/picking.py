"""From what a user names to a provider: a known model, a path, an address or a file."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from executive.core.errors import InputError
from executive.core.registry import closest
from perception.shelf.language.carried import CARRIED
from perception.shelf.language.endpoint import EndpointModel
from perception.shelf.language.prompts import PROMPTS
from perception.shelf.language.providers import (
    EmbeddingProvider,
    FileProvider,
    PromptedProvider,
    Provider,
)
from perception.shelf.language.scores import Source
from perception.shelf.language.transformers_models import (
    CausalModel,
    ModelFiles,
    SentenceEmbedder,
    library_versions,
)


@dataclass(frozen=True, slots=True)
class Wanted:
    """How a model is to be asked.

    Attributes:
        prompts: What to ask a language model.
        served_model: Name of the model at an address.
        embeds: Whether a model by path is an embedder.
    """

    prompts: tuple[str, ...] = PROMPTS
    served_model: str = ""
    embeds: bool = False


@contextmanager
def provider_of(text: str, wanted: Wanted | None = None) -> Iterator[Provider]:
    """Give the provider that a text means.

    Args:
        text: A name of `CARRIED`; a folder or a .gguf file; an address that begins with http; or a
            .json file with a matrix.
        wanted: How to ask; None for the defaults.

    Raises:
        InputError: It means nothing that is known, or the model cannot be loaded.
    """
    wanted = wanted or Wanted()
    if text in CARRIED:
        with CARRIED[text].files() as files:
            carried = CARRIED[text]
            source = _source(text, carried.version, carried.licence)
            yield _local(files, source, wanted, embeds=carried.embeds)
    elif text.startswith(("http://", "https://")):
        yield PromptedProvider(_endpoint(text, wanted), wanted.prompts)
    else:
        yield _from_path(text, wanted)


def _from_path(text: str, wanted: Wanted) -> Provider:
    path = Path(text)
    if not path.exists():
        raise InputError(
            f"--model {text}: neither a known model nor a path; {closest(text, [*CARRIED])}; "
            f"try: a folder, a .gguf file, a .json matrix or http://..."
        )
    if path.suffix == ".json":
        return FileProvider(path)
    if path.is_dir():
        files = ModelFiles(path)
    elif path.suffix == ".gguf":
        files = ModelFiles(path.parent, path.name)
    else:
        raise InputError(
            f"--model {text}: got a file that ends in {path.suffix or 'nothing'}; "
            f"expected a folder, .gguf or .json"
        )
    source = _source(path.stem, "", "as its files say")
    return _local(files, source, wanted, embeds=wanted.embeds)


def _local(files: ModelFiles, source: Source, wanted: Wanted, *, embeds: bool) -> Provider:
    if embeds:
        return EmbeddingProvider(SentenceEmbedder(files, source))
    return PromptedProvider(CausalModel(files, source), wanted.prompts)


def _endpoint(address: str, wanted: Wanted) -> EndpointModel:
    if not wanted.served_model:
        raise InputError(
            f"--model {address}: expected the name of a model there; try --served-model NAME"
        )
    return EndpointModel(address, wanted.served_model)


def _source(name: str, version: str, licence: str) -> Source:
    versions = ", ".join(part for part in (version, library_versions()) if part)
    return Source(name, versions, licence, datetime.now(UTC).date().isoformat())
