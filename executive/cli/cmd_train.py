"""`cellwright train`: draw cables, and train the networks that see them."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeVar, cast

import typer

from executive.cli.console import chatter
from executive.cli.train_folders import begin, interruptible, need_learning
from executive.core.errors import InputError
from executive.core.registry import closest
from perception.training.tasks import AFTER, TASKS

if TYPE_CHECKING:
    from pydantic import ValidationError

    from perception.training.dataset import DataSettings, Renderer
    from perception.training.recipes import VersionRecipe

train = typer.Typer(
    help="Draw cables with exact truth, and train what sees them.", no_args_is_help=True
)

Number = TypeVar("Number", int, float)

DEFAULT_HOURS = 2.0
RECIPE = "recipe.yaml"

Out = Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder; empty or new.")]
Resume = Annotated[bool, typer.Option("--resume", help="Go on with what is in that folder.")]


@train.command()
def data(
    out: Out,
    images: Annotated[int, typer.Option(min=1, help="How many images, or samples.")] = 100,
    seed: Annotated[int, typer.Option(min=0, help="Of every image.")] = 0,
    family: Annotated[
        str | None,
        typer.Option(help="Curves: random, parallel, dense, coil, hairpin, tight or settled."),
    ] = None,
    style: Annotated[str | None, typer.Option(help="Looks: photograph, shaded or plain.")] = None,
    cables: Annotated[str, typer.Option(metavar="N[-N]", help="Cables in an image.")] = "1-3",
    size: Annotated[
        str | None, typer.Option(metavar="WxH", help="Of images, in pixels; squares by default.")
    ] = None,
    width: Annotated[
        str, typer.Option(metavar="PX[-PX]", help="Width of cables, in pixels.")
    ] = "4-14",
    renderer: Annotated[
        str, typer.Option(help="What shows them: own, or blender, which takes seconds an image.")
    ] = "own",
    crops: Annotated[
        str | None,
        typer.Option(metavar="TASK", help="Samples of a network as arrays instead of images."),
    ] = None,
    resume: Resume = False,
) -> None:
    """Draw images of cables: PNG files, the truth about each as JSON, contact sheets."""
    if crops is not None:
        _draw_crops(crops, out, images, seed)
        return
    from pydantic import ValidationError

    from perception.training.blender import need_blender
    from perception.training.dataset import INDEX, DataSettings

    try:
        settings = DataSettings(
            images=images,
            seed=seed,
            family=family,
            style=style,
            cables=_numbers("--cables", cables, "-", "2 or 1-3", int),
            size_px=None if size is None else _numbers("--size", size, "x", "640x480", int),
            width_px=_numbers("--width", width, "-", "6 or 4-14", float),
            renderer=cast("Renderer", renderer),
        )
    except ValidationError as error:
        raise InputError(_faults(error)) from None
    if settings.renderer == "blender":
        need_blender()
    begin(out, resume, INDEX)
    with interruptible(out):
        _draw_images(settings, out)


def _faults(error: "ValidationError") -> str:
    """Return what is wrong with options, a line each."""
    return "\n".join(
        f"--{fault['loc'][0]}: {fault['msg']}; got {fault['input']!r}"
        if fault["loc"]
        else f"--{fault['msg'].removeprefix('Value error, ')}"
        for fault in error.errors()
    )


def _draw_images(settings: "DataSettings", out: Path) -> None:
    from rich.progress import track

    from perception.training.dataset import SHEET, TRUTH_SHEET, write_images, write_sheets

    drawn = write_images(settings, out)
    for _ in track(drawn, "drawing", settings.images, console=chatter(), transient=True):
        pass
    write_sheets(out)
    chatter().print(
        f"{settings.images} images in {out}; look at {out / SHEET} and {out / TRUTH_SHEET}"
    )


def _draw_crops(task: str, out: Path, count: int, seed: int) -> None:
    _check_task("--crops", task)
    need_learning("train data --crops")
    begin(out, False, RECIPE)
    from perception.training.crops import ARRAYS, write_crops
    from perception.training.dataset import SHEET

    with interruptible(out):
        write_crops(task, seed, count, out)
    chatter().print(f"{count} samples in {out / ARRAYS}; look at {out / SHEET}")


def _numbers(
    option: str, text: str, between: str, example: str, kind: Callable[[str], Number]
) -> tuple[Number, Number]:
    """Return both numbers of a text such as `4-14`, or the only one twice."""
    try:
        parts = [kind(part) for part in text.lower().split(between)]
        first, last = parts if len(parts) > 1 else parts * 2
    except ValueError:
        raise InputError(f"{option}: got {text!r}; expected such as {example}") from None
    return first, last


def _check_task(option: str, name: str) -> None:
    if name not in TASKS:
        raise InputError(f"{option}: unknown; got {name!r}; {closest(name, [*TASKS])}")


def _train_one(task: str) -> Callable[..., None]:
    """Return the command that trains one task."""

    def command(
        out: Out,
        hours: Annotated[
            float | None,
            typer.Option(min=1e-6, help="Process time; 2 unless --samples is given."),
        ] = None,
        samples: Annotated[
            int | None, typer.Option(min=1, help="Samples; alone, it makes trainings the same.")
        ] = None,
        seed: Annotated[int, typer.Option(min=0, help="Of weights and samples.")] = 1,
        start: Annotated[
            str, typer.Option(metavar="VERSION", help="Trained version or weights to start from.")
        ] = "",
        resume: Resume = False,
    ) -> None:
        need_learning(f"train {task}")
        begin(out, resume, RECIPE)
        from perception.training.recipes import AfterStep, Recipe, VersionRecipe, read_recipe

        if resume:
            _run(read_recipe(out / RECIPE), out)
            return
        if samples is None and hours is None:
            hours = DEFAULT_HOURS
        usual = Recipe(seed=seed, start=start, hours=hours)
        stage = usual if samples is None else usual.model_copy(update={"samples": samples})
        after = tuple(AfterStep(step=step) for step in AFTER[task])
        _run(VersionRecipe(task=task, stages=(stage,), after=after), out)

    command.__doc__ = f"Train the network for `{task}`, then calibrate it."
    return command


for _task in TASKS:
    train.command(_task)(_train_one(_task))


@train.command("all")
def train_all(
    out: Out,
    scale: Annotated[
        float,
        typer.Option("--hours-scale", min=1e-9, help="How much of the work of the recipes."),
    ] = 1.0,
    recipes: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Folders with recipes; those of the project by default."),
    ] = None,
    every: Annotated[
        bool, typer.Option("--every", help="Older versions, too, not only the newest.")
    ] = False,
    resume: Resume = False,
) -> None:
    """Train everything again by the recipes of its versions."""
    need_learning("train all")
    from perception.training.recipes import newest_recipes, read_recipes

    found = read_recipes(recipes)
    begin(out, resume, "")
    chosen = found if every else newest_recipes(found)
    for name, recipe in chosen.items():
        chatter().print(f"{name}: {recipe.task}")
        _run(recipe.scaled(scale), out / name)
    chatter().print(f"{len(chosen)} versions in {out}")


def _run(recipe: "VersionRecipe", out: Path) -> None:
    from executive.cli.train_display import training_shown
    from perception.training.loop import TrainingStoppedError
    from perception.training.versions import train_version

    try:
        with interruptible(out), training_shown() as reporter:
            train_version(recipe, out, reporter)
    except TrainingStoppedError as error:
        chatter().print(f"{error}; go on with --resume")
        raise typer.Exit(130) from None
