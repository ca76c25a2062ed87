"""The YAML document of a campaign: which mission, with what, how often, within which limits."""

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, StringConstraints, ValidationError, model_validator

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
    seeds: SeedRange | Annotated[tuple[Seed, ...], Field(min_length=1)] = SeedRange(count=1)
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


def _faults(source: Source, error: ValidationError) -> list[Fault]:
    """Say what pydantic found, once a place."""
    known = [field.alias or name for name, field in CampaignDocument.model_fields.items()]
    found: dict[YamlPath, str] = {}
    for detail in error.errors(include_url=False, include_input=False):
        path = tuple(part for part in detail["loc"] if part != "[key]")
        message = detail["msg"].removeprefix("Value error, ")
        if detail["type"] == "extra_forbidden":
            message = f"unknown key {path[-1]!r}"
            message += f"; {closest(str(path[-1]), known)}" if len(path) == 1 else ""
        elif detail["type"] == "missing":
            message = f"missing key {path[-1]!r}"
        else:
            message = ".".join(str(part) for part in path) + f": {message}"
        found.setdefault(path, message)
    return [Fault(source.file, *source.key_mark(path), "", said) for path, said in found.items()]
