"""Make a trained version: stages, weights, what comes after, and a card, in one folder."""

import json
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path

from safetensors.torch import save_file
from torch import Tensor

from executive.core.errors import InputError
from executive.core.registry import closest
from perception.models.checksums import write_checksum
from perception.models.store import FOLDER, ModelConfig
from perception.training.cards import write_card
from perception.training.loop import Task, Trainer
from perception.training.progress import Reporter
from perception.training.recipes import PREVIOUS, Recipe, VersionRecipe, write_recipe
from perception.training.tasks import load_step, load_task

WEIGHTS = "weights.safetensors"
WORK = ("samples", "hours")


def train_version(recipe: VersionRecipe, folder: Path, reporter: Reporter) -> None:
    """Train a version into a folder; what is finished of it already is left as it is.

    Args:
        recipe: How.
        folder: Of the version; stages that are under way lie in it, too.
        reporter: Tells of it.

    Raises:
        InputError: The task or some weights to start from do not exist.
        TrainingStoppedError: The process was asked to stop; calling this again goes on.
    """
    task = load_task(recipe.task)
    starts = [_check_start(stage, number) for number, stage in enumerate(recipe.stages)]
    folder.mkdir(parents=True, exist_ok=True)
    write_recipe(folder / "recipe.yaml", recipe)
    if not (folder / WEIGHTS).exists():
        figures = [
            _train_stage(task, stage, folder, number, start, reporter)
            for number, (stage, start) in enumerate(zip(recipe.stages, starts, strict=True))
        ]
        _keep(task, recipe, folder, figures)
    if not (folder / "card.md").exists():
        for step in recipe.after:
            reporter.note(f"{recipe.task}: {step.step}")
            load_step(step.step)([str(folder), *step.options()])
        write_card(recipe, folder)
    for number in range(len(recipe.stages)):
        shutil.rmtree(_stage(folder, number), ignore_errors=True)


def _stage(folder: Path, number: int) -> Path:
    return folder / f"stage_{number + 1}"


def _check_start(stage: Recipe, number: int) -> Path | None:
    """Return the weights that a stage starts from, None for random ones or the stage before."""
    if (stage.start == PREVIOUS or stage.goes_on) and number == 0:
        raise InputError("stages/0: goes on from the stage before; expected a stage before it")
    if stage.start in ("", PREVIOUS):
        return None
    for path in (Path(stage.start), FOLDER / stage.start / WEIGHTS):
        if path.is_file():
            return path
    known = sorted(path.parent.name for path in FOLDER.glob(f"*/{WEIGHTS}"))
    raise InputError(
        f"start: no weights; got {stage.start!r}; expected a file or the name of a trained "
        f"version; {closest(stage.start, known)}"
    )


def _train_stage(
    task: Task, stage: Recipe, folder: Path, number: int, start: Path | None, reporter: Reporter
) -> dict[str, float]:
    own, before = _stage(folder, number), _stage(folder, number - 1)
    finished = own / "finished.json"
    if finished.exists():
        figures: dict[str, float] = json.loads(finished.read_text())
        return figures
    own.mkdir(exist_ok=True)
    if stage.goes_on and not (own / "checkpoint.pt").exists():
        shutil.copy(before / "checkpoint.pt", own / "checkpoint.pt")
    reporter.note(f"{task.name}: stage {number + 1}")
    trainer = Trainer(task, stage, own, before / WEIGHTS if stage.start == PREVIOUS else start)
    measured = trainer.run(reporter)
    measured |= {"samples": trainer.seen, "hours": trainer.hours}
    save_file(compact(trainer.average.module.state_dict()), own / WEIGHTS)
    _write(finished, measured)
    return measured


def compact(weights: Mapping[str, Tensor]) -> dict[str, Tensor]:
    """Return weights to store: kernels at half precision, all else as it is."""
    return {
        name: (tensor.half() if tensor.dim() > 1 else tensor).detach().contiguous()
        for name, tensor in weights.items()
    }


def _keep(
    task: Task, recipe: VersionRecipe, folder: Path, figures: Sequence[Mapping[str, float]]
) -> None:
    """Write what the last stage has learned, and what all of them took."""
    shutil.copy(_stage(folder, len(figures) - 1) / WEIGHTS, folder / WEIGHTS)
    write_checksum(folder / WEIGHTS)
    config = ModelConfig(network=task.name, widths=task.widths, zoom=task.zoom)
    (folder / "config.json").write_text(config.model_dump_json(indent=2) + "\n")
    held_out = {name: value for name, value in figures[-1].items() if name not in WORK}
    # Stages that go on have counted what was before them.
    following = [*recipe.stages[1:], None]
    own = [
        each
        for each, stage in zip(figures, following, strict=True)
        if stage is None or not stage.goes_on
    ]
    work = {name: sum(each[name] for each in own) for name in WORK}
    _write(folder / "metrics.json", {"held_out": held_out, **work})


def _write(path: Path, content: Mapping[str, object]) -> None:
    path.write_text(json.dumps(content, indent=2) + "\n")
