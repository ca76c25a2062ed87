"""The command line of one training by itself: `python -m perception.training.TASK`."""

import argparse
from pathlib import Path

from pydantic import ValidationError

from executive.core.errors import InputError
from perception.training.loop import Task
from perception.training.progress import PlainReporter
from perception.training.recipes import Recipe, VersionRecipe
from perception.training.tasks import task_name
from perception.training.versions import train_version


def main(task: Task) -> None:
    """Train one stage, going on if it was stopped, and write the version."""
    parser = argparse.ArgumentParser(prog=f"python -m perception.training.{task.name}")
    parser.add_argument("--out", type=Path, required=True, help="folder of the trained version")
    for name, field in Recipe.model_fields.items():
        flag = f"--{name.replace('_', '-')}"
        parser.add_argument(flag, default=field.default, help=f"default {field.default}")
    options = vars(parser.parse_args())
    folder = options.pop("out")
    try:
        stage = Recipe.model_validate(options)
    except ValidationError as error:
        parser.error(str(error))
    try:
        train_version(VersionRecipe(task=task_name(task), stages=(stage,)), folder, PlainReporter())
    except InputError as error:
        parser.exit(2, f"{error}\n")
