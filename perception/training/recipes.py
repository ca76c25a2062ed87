"""How a version is trained: the file `recipe.yaml` of every trained version."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Literal

import yaml
from pydantic import BaseModel, ConfigDict, Field, PositiveInt, ValidationError

from executive.core.errors import InputError

FILE = "recipe.yaml"
VERSIONS = Path(__file__).parents[1] / "models"
PREVIOUS = "previous"
# However little is trained, this much is measured on.
LEAST = 2

Positive = Annotated[float, Field(gt=0.0)]
Share = Annotated[float, Field(ge=0.0, lt=1.0)]


class Recipe(BaseModel):
    """How to train, one stage of it.

    Attributes:
        seed: Of the initial weights and of every scene.
        samples: Samples that the learning rate comes down over.
        stop: Stop after this many already; none for all.
        hours: Stop after this much process time, even with fewer samples; none for no limit.
            Busy machines count no more than idle ones. Only trainings without it are the same
            each time, as the learning rate comes down with whichever is nearer its end.
        batch: Samples a step.
        rate: Highest learning rate (AdamW, cosine after a short warm-up).
        decay: Weight decay.
        average: Decay of the running average of the weights.
        threads: Threads of the network's own work.
        workers: Processes that draw samples; 0 to draw them in between.
        held_out_seed: Of the scenes that are only measured on.
        held_out_batches: How many batches of them.
        report_s: Time between reports and checkpoints [s].
        start: Weights to start from: empty for random ones, `previous` for those of the stage
            before, the name of a trained version, or a file.
        goes_on: Whether the optimiser and the running average of the stage before go on, too.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    seed: int = 1
    samples: PositiveInt = 3_000_000
    stop: PositiveInt | None = None
    hours: Positive | None = None
    batch: PositiveInt = 128
    rate: Positive = 2e-3
    decay: Annotated[float, Field(ge=0.0)] = 1e-4
    average: Share = 0.998
    threads: PositiveInt = 1
    workers: Annotated[int, Field(ge=0)] = 1
    held_out_seed: int = 900_001
    held_out_batches: PositiveInt = 24
    report_s: Positive = 240.0
    start: str = ""
    goes_on: bool = False

    def scaled(self, scale: float) -> "Recipe":
        """Return the same with `scale` times the work."""
        return self.model_copy(
            update={
                "samples": max(round(self.samples * scale), 1),
                "stop": None if self.stop is None else max(round(self.stop * scale), 1),
                "hours": None if self.hours is None else self.hours * scale,
                "held_out_batches": max(
                    min(round(self.held_out_batches * scale), self.held_out_batches), 1
                ),
            }
        )


class AfterStep(BaseModel):
    """Something done to a version once it is trained.

    Attributes:
        step: One of `perception.training.tasks.STEPS`.
        batches: How many batches of samples it takes, none for as many as usual.
        scenes: How many scenes it takes, none for as many as usual.
        held_out: How many scenes it measures on, none for as many as usual.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    step: str
    batches: PositiveInt | None = None
    scenes: PositiveInt | None = None
    held_out: PositiveInt | None = None

    def options(self) -> list[str]:
        """Return its options for a command line."""
        return [
            word
            for name, count in self._counts().items()
            for word in (f"--{name.replace('_', '-')}", str(count))
        ]

    def scaled(self, scale: float) -> "AfterStep":
        """Return the same with `scale` times the work."""
        counts = self._counts().items()
        return self.model_copy(
            update={name: max(round(count * scale), LEAST) for name, count in counts}
        )

    def _counts(self) -> dict[str, int]:
        counts = {"batches": self.batches, "scenes": self.scenes, "held_out": self.held_out}
        return {name: count for name, count in counts.items() if count is not None}


class VersionRecipe(BaseModel):
    """The file `recipe.yaml`: one stage after the other, and what comes after.

    Attributes:
        format: Of this file.
        task: What is trained, one of `perception.training.tasks`.
        about: What to know before doing it again.
        stages: How; a stage begins with a fresh optimiser unless it `goes_on`.
        after: What is then done to it, such as calibration.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    format: Literal[1] = 1
    task: str
    about: str = ""
    stages: Annotated[tuple[Recipe, ...], Field(min_length=1)]
    after: tuple[AfterStep, ...] = ()

    def scaled(self, scale: float) -> "VersionRecipe":
        """Return the same with `scale` times the work."""
        stages = tuple(stage.scaled(scale) for stage in self.stages)
        after = tuple(step.scaled(scale) for step in self.after)
        return self.model_copy(update={"stages": stages, "after": after})


def read_recipe(path: Path) -> VersionRecipe:
    """Return the recipe in a file.

    Raises:
        InputError: It is no recipe.
    """
    try:
        return VersionRecipe.model_validate(yaml.safe_load(path.read_text()))
    except OSError as error:
        raise InputError(f"{path}: cannot be read; {error.strerror}") from error
    except yaml.YAMLError as error:
        raise InputError(f"{path}: no YAML; {error}") from error
    except ValidationError as error:
        faults = "\n".join(
            f"{path}: {'/'.join(map(str, fault['loc']))}: {fault['msg']}; got {fault['input']!r}"
            for fault in error.errors()
        )
        raise InputError(faults) from error


def read_recipes(folder: Path | None = None) -> dict[str, VersionRecipe]:
    """Return the recipes of all versions in a folder, by name.

    Args:
        folder: Of versions, or of one; none for those of this project.

    Raises:
        InputError: One of them is no recipe, or there are none.
    """
    where = folder or VERSIONS
    paths = [where / FILE] if (where / FILE).is_file() else sorted(where.glob(f"*/{FILE}"))
    if not paths:
        raise InputError(f"{where}: no {FILE} in it, nor in a folder of it; try a version's folder")
    return {path.absolute().parent.name: read_recipe(path) for path in paths}


def newest_recipes(recipes: Mapping[str, VersionRecipe]) -> dict[str, VersionRecipe]:
    """Return the recipe of the newest version of each task: the one with the highest number."""

    def number(name: str) -> int:
        return int("".join(filter(str.isdigit, name.rpartition("_")[2])) or 0)

    newest: dict[str, str] = {}
    for name in sorted(recipes, key=number):
        newest[recipes[name].task] = name
    return {name: recipes[name] for name in newest.values()}


def write_recipe(path: Path, recipe: VersionRecipe) -> None:
    """Write a recipe, without what is as usual."""
    document = recipe.model_dump(mode="json", exclude_defaults=True)
    path.write_text(yaml.safe_dump({"format": 1, **document}, sort_keys=False))
