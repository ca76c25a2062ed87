"""The page on faults against the code: its table of kinds, and the commands that it runs."""

import re
import shlex
from pathlib import Path

from typer.testing import CliRunner

from executive.cli.main import app
from executive.engine.faults.grammar import Kind, parse_injection

PAGE = (Path(__file__).parents[2] / "docs" / "faults.md").read_text(encoding="utf-8")
EXAMPLES, UNTANGLING = PAGE.split("## The untangling mission")


def blocks(language, text=EXAMPLES):
    return re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)


def said(text):
    """Return lines without what differs from run to run: times of this machine."""
    return [re.sub(r"[\d.]+ s here", "", line).rstrip() for line in text.strip().splitlines()]


def test_every_fault_of_the_table_is_one_and_every_kind_is_there():
    rows = re.findall(r"^\| (`[^|]+`) \| ", EXAMPLES, re.MULTILINE)
    faults = [text for row in rows for text in re.findall(r"`([^`]+: [^`]+)`", row)]
    assert {parse_injection(fault).kind for fault in faults} == set(Kind)


def test_the_examples_give_what_is_shown(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    stubs, mission = blocks("yaml")
    Path("fetch_stubs.yaml").write_text(stubs)
    Path("fetch.yaml").write_text(mission)
    for block in blocks("console"):
        command, _, shown = block.removeprefix("$ ").partition("\n")
        result = CliRunner().invoke(app, shlex.split(command)[1:])
        assert said(result.stdout) == said(shown)
