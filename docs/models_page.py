"""Prints docs/models.md from the folders of the trained versions (`make pages`)."""

import json
import sys
from collections.abc import Sequence
from pathlib import Path

import yaml

_MODELS = Path(__file__).parents[1] / "perception" / "models"
_INTRODUCTION = """\
# Trained networks

Every trained version that ships, with its figures on scenes that its training never saw. This page
is written by `make pages` from the folders in `perception/models`; the card in each tells more. How
they are made is [told here](perception.md). Versions were held to the scenes of their day, which
have become harder, so figures of one column are no race.

"""
_COLUMNS = (
    "version",
    "trains",
    "samples",
    "held out",
    "right",
    "calibration error",
    "error of the surest 80 %",
    "size",
)


def page() -> str:
    """Return the page as Markdown."""
    folders = sorted(path.parent for path in _MODELS.glob("*/metrics.json"))
    head = [_line(_COLUMNS), "|" + "---|" * len(_COLUMNS) + "\n"]
    return _INTRODUCTION + "".join([*head, *(_row(folder) for folder in folders)])


def _row(folder: Path) -> str:
    metrics = json.loads((folder / "metrics.json").read_text(encoding="utf-8"))
    recipe = yaml.safe_load((folder / "recipe.yaml").read_text(encoding="utf-8"))
    held = metrics["calibration"]
    right = held.get("right", held.get("ends_right"))
    size_mb = (folder / "weights.safetensors").stat().st_size / 1e6
    cells = [
        f"`{folder.name}`",
        f"`{recipe['task']}`",
        f"{metrics['samples']:,}",
        f"{held['n']:,}",
        f"{100.0 * right:.1f} %",
        # What is no probability has no such figures.
        f"{held['calibration_error']:.3f}" if "calibration_error" in held else "",
        f"{100.0 * held['error_of_surest_80']:.1f} %" if "calibration_error" in held else "",
        f"{size_mb:.1f} MB",
    ]
    return _line(cells)


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |\n"


if __name__ == "__main__":
    sys.stdout.write(page())
