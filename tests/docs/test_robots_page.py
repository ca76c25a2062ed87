"""The page on robots: its example runs, its tables are those of the code."""

import re
from pathlib import Path
from typing import get_args

import pytest
from pydantic import BaseModel

from executive.core.errors import InputError
from robots.interfaces import Cause
from simulation.table_cell_config import TableCellConfig

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "robots.md").read_text(encoding="utf-8")
SNIPPETS = re.findall(r"^```python\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)


def words(row):
    line = re.search(rf"^\| `{row}`[^|]*\| (.*) \|$", PAGE, re.MULTILINE)[1]
    return re.findall(r"`([\w.]+)`", line)


def test_the_first_example_reads_files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=r"mine\.urdf: cannot be read"):
        exec(compile(SNIPPETS[0], "docs/robots.md, example 1", "exec"), {})


def test_the_arm_of_the_page_plans():
    exec(compile(SNIPPETS[1], "docs/robots.md, example 2", "exec"), {})


def test_causes_are_those_of_the_code():
    assert set(words("cause")) == set(get_args(Cause))


def settings(model, above=""):
    """Yield the dotted names of all settings with their defaults."""
    for name, field in model.model_fields.items():
        if isinstance(field.default, BaseModel):
            yield from settings(type(field.default), f"{above}{name}.")
        else:
            yield f"{above}{name}", field.default


def test_the_settings_of_the_table_cell_are_all_there_with_their_defaults():
    table = PAGE.split("## The table cell", 1)[1]
    rows = re.findall(r"^\| (`.*) \| (.*) \| .* \|$", table, re.MULTILINE)
    told = {}
    for names, values in rows:
        keys = re.findall(r"`([\w.]+)`", names)
        told |= dict(zip(keys, [value.strip("` ") for value in values.split(",")], strict=True))
    known = dict(settings(TableCellConfig))
    assert set(told) == set(known)
    for name, value in told.items():
        default = known[name]
        assert value == default if isinstance(default, str) else float(value) == default


def test_codes_and_stages_are_all_that_the_code_gives():
    sources = [file.read_text("utf-8") for file in (ROOT / "robots").rglob("*.py")]
    codes = {code for text in sources for code in re.findall(r'"(motion\.\w+)"', text)}
    assert codes <= set(words("code"))
    assert set(words("stage")) == {"ik", "path", "line", "timing", "verify"}
