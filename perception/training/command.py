"""The command line of every training."""

import argparse
import json
from dataclasses import asdict
from pathlib import Path

from safetensors.torch import save_file

from perception.training.loop import Recipe, Task, Trainer


def main(task: Task) -> None:
    """Train, and write weights, config, recipe and figures."""
    parser = argparse.ArgumentParser(prog=f"python -m perception.training.{task.name}")
    parser.add_argument("--out", type=Path, required=True, help="folder of the trained version")
    defaults = asdict(Recipe())
    for name, value in defaults.items():
        flag = f"--{name.replace('_', '-')}"
        parser.add_argument(flag, type=type(value), default=value, help=f"default {value}")
    options = vars(parser.parse_args())
    folder = options.pop("out")
    folder.mkdir(parents=True, exist_ok=True)
    recipe = Recipe(**options)
    trainer = Trainer(task, recipe, folder)
    figures = trainer.run()
    weights = {
        name: tensor.detach().contiguous()
        for name, tensor in trainer.average.module.state_dict().items()
    }
    save_file(weights, folder / "weights.safetensors")
    _write(folder / "config.json", {"network": task.name, "widths": task.widths})
    _write(
        folder / "metrics.json",
        {"held_out": figures, "samples": trainer.seen, "hours": trainer.hours},
    )
    settings = "".join(f"{name}: {value}\n" for name, value in asdict(recipe).items())
    command = f"command: python -m perception.training.{task.name}\n"
    (folder / "recipe.yaml").write_text(command + settings)


def _write(path: Path, content: dict[str, object]) -> None:
    path.write_text(json.dumps(content, indent=2) + "\n")
