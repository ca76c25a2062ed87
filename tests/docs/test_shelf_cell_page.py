"""The page on the shelf cell: its example runs, and it knows every setting."""

import re
from pathlib import Path

from pydantic import BaseModel

from simulation.shelf_cell.config import ShelfCellConfig, ShelfScenario
from simulation.shelf_cell.truth import ShelfTruth

PAGE = (Path(__file__).parents[2] / "docs/shelf_cell.md").read_text(encoding="utf-8")


def settings(model: type[BaseModel], prefix: str = "") -> list[str]:
    """Return the names of all settings, those of parts after a dot."""
    found = []
    for name, field in model.model_fields.items():
        part = field.annotation
        if isinstance(part, type) and issubclass(part, BaseModel):
            found += settings(part, f"{name}.")
        else:
            found.append(f"{prefix}{name}")
    return found


def test_example_of_the_page_runs():
    (example,) = re.findall(r"^```python\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    exec(compile(example, "docs/shelf_cell.md", "exec"), {})


def test_page_names_every_setting():
    named = set(re.findall(r"`([\w.]+)`", PAGE))
    wanted = [*settings(ShelfCellConfig), *settings(ShelfScenario)]
    recorded = {"physics.joint_states_hz", "physics.scene_hz"}
    assert [name for name in wanted if name not in named | recorded] == []


def test_page_names_what_is_scored():
    named = set(re.findall(r"`([\w.]+)`", PAGE))
    told = {"target", "visible_share", "toppled_names"}
    assert set(ShelfTruth.__slots__) - named - told == set()
