"""The page on seeing the cable: its commands run, its tables name what there is."""

import re
import shlex
from pathlib import Path

import pytest
from typer.testing import CliRunner

from executive.cli.main import app
from perception.training import dataset
from perception.training.curves import FAMILIES
from perception.training.dataset import INDEX, SHEET, TRUTH_SHEET
from perception.training.drawn import DrawnScene
from perception.training.looks import STYLES

PAGE = (Path(__file__).parents[2] / "docs" / "perception.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^ *```sh\n(.*?)^ *```", PAGE, re.MULTILINE | re.DOTALL)
COMMANDS = [shlex.split(line)[1:] for block in BLOCKS for line in block.splitlines() if line]


def test_commands_that_draw_and_look_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    # Numbers of images are for people; what the others look at is number 3.
    monkeypatch.setattr(dataset, "ON_SHEET", 4)
    drawing = [command for command in COMMANDS if "--crops" not in command]
    for command in drawing:
        if command[:2] == ["train", "data"]:
            images = "4" if "cables" in command else "1"
            command = [*command, "--images", images]
        if command[:2] == ["train", "data"] or command[0] == "perceive":
            result = CliRunner().invoke(app, command)
            assert result.exit_code == 0, (command, result.output, result.exception)
    assert Path("seen.png").exists()
    assert {path.name for path in Path("cables").iterdir()} > {INDEX, SHEET, TRUTH_SHEET}


def test_commands_that_train_are_understood(tmp_path, monkeypatch):
    pytest.importorskip("torch")
    from perception.training import versions
    from perception.training.recipes import newest_recipes, read_recipes

    monkeypatch.chdir(tmp_path)
    asked = {}
    monkeypatch.setattr(
        versions, "train_version", lambda recipe, folder, _: asked.update({str(folder): recipe})
    )
    for command in COMMANDS:
        if command[0] == "train" and command[1] != "data":
            result = CliRunner().invoke(app, command)
            assert result.exit_code == 0, (command, result.output, result.exception)
    assert asked["my_tracer"].stages[0].hours == 2.0
    assert asked["my_sight"].stages[0].hours is None
    assert asked["mine_v1"].stages[0].start == "tracer_v2"
    assert {f"models/{name}" for name in newest_recipes(read_recipes())} < set(asked)


def test_the_recipe_shown_is_one(tmp_path):
    from perception.training.recipes import read_recipe

    (shown,) = re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)
    (tmp_path / "recipe.yaml").write_text(shown)
    assert len(read_recipe(tmp_path / "recipe.yaml").stages) == 2


def test_families_styles_and_keys_are_those_of_the_code():
    assert {name for name in FAMILIES if f"`{name}`" in PAGE} == set(FAMILIES)
    assert {name for name in STYLES if f"`{name}`" in PAGE} == set(STYLES)
    table = re.search(r"\| key \| what it is \|\n(.*?)\n\n", PAGE, re.DOTALL)
    keys = set(re.findall(r"^\| `(\w+)`", table[1], re.MULTILINE))
    assert keys == set(DrawnScene.model_fields) - {"format", "image"}
