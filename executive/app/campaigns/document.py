"""The YAML document of a campaign: which mission, with what, how often, within which limits."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import (
    BaseModel,
    Discriminator,
    Field,
    StringConstraints,
    Tag,
    ValidationError,
    model_validator,
)
from pydantic_core import ErrorDetails

from executive.core.errors import DocumentError, Fault, InputError
from executive.core.registry import closest
from executive.engine.language.fields import Count, Model, Name, Seconds, Text
from executive.engine.language.sources import Source, YamlPath, read_source

Seed = Annotated[int, Field(strict=True, ge=0)]
Key = Annotated[str, StringConstraints(strict=True, pattern=r"^[a-z][a-z0-9_]*(\.\w+)*$")]
Bound = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Values = Annotated[tuple[Any, ...], Field(min_length=1)]


class SeedRange(Model):
    """Seeds that follow each other."""

    first: Seed = 0
    count: Count


_RANGE, _LIST = "a range", "a list"
Seeds = Annotated[
    Annotated[SeedRange, Tag(_RANGE)]
    | Annotated[tuple[Seed, ...], Field(min_length=1), Tag(_LIST)],
    Discriminator(lambda given: _RANGE if isinstance(given, dict | SeedRange) else _LIST),
]


class Draw(Model):
    """How a value is drawn: exactly one of these."""

    uniform: tuple[Bound, Bound] | None = Field(default=None, description="Lowest and highest.")
    log_uniform: tuple[Bound, Bound] | None = Field(
        default=None, description="Lowest and highest, both above 0; its logarithm is uniform."
    )
    integers: tuple[int, int] | None = Field(
        default=None, description="Lowest and highest, both drawn."
    )
    choice: Values | None = Field(default=None, description="Any of these, each as likely.")

    @model_validator(mode="after")
    def _one_way(self) -> "Draw":
        given = [name for name in type(self).model_fields if getattr(self, name) is not None]
        if len(given) != 1:
            raise ValueError(f"expected one of {', '.join(type(self).model_fields)}; got {given}")
        bounds = getattr(self, given[0])
        if given[0] != "choice" and bounds[0] > bounds[1]:
            raise ValueError(f"the lowest comes first; got {list(bounds)}")
        if given[0] == "log_uniform" and bounds[0] <= 0.0:
            raise ValueError(f"a logarithm needs bounds above 0; got {list(bounds)}")
        return self


class Sample(Model):
    """Settings that are drawn at random, so and so often."""

    count: Count
    seed: Seed = 0
    of: Annotated[dict[Key, Draw], Field(min_length=1)]


class Limits(Model):
    """What a run may take; one that takes more is ended and loses only itself."""

    timeout_s: Seconds | None = Field(
        default=None, description="On the cell's clock [s]; that of the mission otherwise."
    )
    wall_s: Seconds = Field(default=600.0, description="On the machine's clock [s].")
    memory_mb: Annotated[float, Field(strict=True, gt=0.0)] | None = Field(
        default=None, description="Memory of the run's process [MB]; no limit otherwise."
    )


class CampaignDocument(Model):
    """One mission, and the runs that are wanted of it."""

    format: Literal[1]
    campaign: Name
    about: Text = ""
    mission: Text = Field(description="Name of a mission, or its file from this document on.")
    seeds: Seeds = SeedRange(count=1)
    set_: dict[Key, Any] = Field(
        default_factory=dict, alias="set", description="Settings of all runs."
    )
    grid: dict[Key, Values] = Field(
        default_factory=dict, description="Values by key; every combination is run."
    )
    sample: Sample | None = None
    list_: tuple[dict[Key, Any], ...] = Field(
        default=(), alias="list", description="Settings that belong together, one entry a variant."
    )
    limits: Limits = Limits()
    keep: Literal["failed", "all", "none"] = Field(
        default="failed", description="Which recordings stay when their run is over."
    )

    @property
    def all_seeds(self) -> tuple[int, ...]:
        """The seeds, each once."""
        if isinstance(self.seeds, SeedRange):
            return tuple(range(self.seeds.first, self.seeds.first + self.seeds.count))
        return tuple(dict.fromkeys(self.seeds))


def read_campaign(file: Path) -> tuple[CampaignDocument, Source]:
    """Read the document of a campaign.

    Raises:
        DocumentError: All that is wrong with it, with its place.
        InputError: It cannot be read.
    """
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{file}: no campaign can be read from it; got {error}") from None
    source = read_source(str(file), text)
    if source.faults:
        raise DocumentError(source.faults)
    try:
        return CampaignDocument.model_validate(source.data), source
    except ValidationError as error:
        raise DocumentError(_faults(source, error)) from None


_MODELS: Mapping[YamlPath, type[BaseModel]] = {
    (): CampaignDocument,
    ("seeds",): SeedRange,
    ("sample",): Sample,
    ("limits",): Limits,
}


def _faults(source: Source, error: ValidationError) -> list[Fault]:
    """Say what pydantic found, once a place."""
    found: dict[YamlPath, str] = {}
    for detail in error.errors(include_url=False, include_input=False):
        path = tuple(part for part in detail["loc"] if part not in ("[key]", _RANGE, _LIST))
        found.setdefault(path, _in_words(path, detail))
    return [Fault(source.file, *source.key_mark(path), "", said) for path, said in found.items()]


def _in_words(path: YamlPath, detail: ErrorDetails) -> str:
    if detail["type"] == "missing":
        return f"missing key {path[-1]!r}"
    if detail["type"] == "extra_forbidden":
        model = _MODELS.get(path[:-1])
        fields = model.model_fields.items() if model else ()
        known = [field.alias or name for name, field in fields]
        return f"unknown key {path[-1]!r}" + (f"; {closest(str(path[-1]), known)}" if known else "")
    place = ".".join(map(str, path))
    if detail["type"] == "too_short":
        return f"{place}: expected at least one"
    message = detail["msg"].removeprefix("Value error, ").replace("a valid tuple", "a list")
    return f"{place}: {message.replace('Input should be', 'expected', 1)}"
