"""The card of a trained version: what it answers, what it learned from, how well it does."""

import json
from collections.abc import Mapping
from pathlib import Path

from perception.training.recipes import VersionRecipe
from perception.training.tasks import load_task

_CARD = """# {name}

{about}

- **Answers**: {answers}
- **Training**: {samples:,} samples of drawn scenes, {hours:.2f} h of process time, {stages}; no
  photograph was used. See `recipe.yaml`.
- **Held-out samples**: {held_out}.
- **Calibration**: {calibration}.
- **To make it again**: `cellwright train all --recipes {name} --out FOLDER`.
"""


def write_card(recipe: VersionRecipe, folder: Path) -> None:
    """Write `card.md` from what else lies in a version's folder."""
    metrics = json.loads((folder / "metrics.json").read_text())
    count = len(recipe.stages)
    card = _CARD.format(
        name=folder.name,
        about=recipe.about or f"Trained as `{recipe.task}`.",
        answers=(type(load_task(recipe.task)).__doc__ or "").strip(),
        samples=metrics["samples"],
        hours=metrics["hours"],
        stages="one stage" if count == 1 else f"{count} stages",
        held_out=_listed(metrics["held_out"]),
        calibration=_listed(metrics.get("calibration", {})) or "none",
    )
    (folder / "card.md").write_text(card)


def _listed(figures: Mapping[str, float]) -> str:
    return ", ".join(f"{name.replace('_', ' ')} {value:g}" for name, value in figures.items())
