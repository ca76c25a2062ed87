"""The command line of every training."""

import argparse
import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path

from safetensors.torch import save_file
from torch import Tensor

from perception.training.loop import Recipe, Task, Trainer


def compact(weights: Mapping[str, Tensor]) -> dict[str, Tensor]:
    """Return weights to store: kernels at half precision, all else as it is."""
    return {
        name: (tensor.half() if tensor.dim() > 1 else tensor).detach().contiguous()
        for name, tensor in weights.items()
    }


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
    weights = trainer.average.module.state_dict()
    save_file(compact(weights), folder / "weights.safetensors")
    _write(folder / "config.json", {"network": task.name, "widths": task.widths, "zoom": task.zoom})
    _write(
        folder / "metrics.json",
        {"held_out": figures, "samples": trainer.seen, "hours": trainer.hours},
    )
    settings = "".join(f"{name}: {value}\n" for name, value in asdict(recipe).items())
    command = f"command: python -m perception.training.{task.name}\n"
    (folder / "recipe.yaml").write_text(command + settings)


def _write(path: Path, content: dict[str, object]) -> None:
    path.write_text(json.dumps(content, indent=2) + "\n")
