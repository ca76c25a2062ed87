"""The page about BehaviorTree.CPP against the code: its tables, and the example that it runs."""

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from executive.cli.main import app
from executive.engine.exchange.vocabulary import CONDITIONS, ENDINGS, PORTS, REFUSED
from executive.engine.language.block_models import KINDS

PAGE = (Path(__file__).parents[2] / "docs" / "exchange.md").read_text(encoding="utf-8")
IMPORTED, EXPORTED = PAGE.split("## What is refused")


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)


def told(text):
    """Return every word in code marks."""
    prose = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    return set(re.findall(r"`([^`]+)`", prose))


@pytest.mark.parametrize("name", sorted({*PORTS, *CONDITIONS, *ENDINGS}))
def test_every_node_and_condition_there_is_in_the_table(name):
    shown = told(IMPORTED) | {f"Switch{n}" for n in range(2, 7)}
    assert name in shown


@pytest.mark.parametrize("name", sorted(REFUSED))
def test_every_refusal_is_told(name):
    assert name in told(EXPORTED)


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_node_here_is_in_the_table(kind):
    assert kind in told(EXPORTED)


def test_the_example_does_what_it_says(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (xml,) = blocks("xml")
    (commands,) = blocks("sh")
    shown, scripted = blocks("yaml")
    Path("fetch_part.xml").write_text(xml)
    for line in commands.splitlines():
        if line.startswith("cellwright run"):
            stubs = Path("fetch/fetch_part_stubs.yaml")
            before = scripted.split("    outcomes:")[0]
            text = stubs.read_text()
            assert before in text
            stubs.write_text(
                text.replace(before + "    outcomes: [{outcome: success}]\n", scripted)
            )
            assert "grasp.missed" in stubs.read_text()
        result = CliRunner().invoke(app, line.split()[1:])
        assert result.exit_code == 0, (line, result.output)
    assert Path("fetch/fetch_part.yaml").read_text() == shown
    assert "<RetryUntilSuccessful" in Path("again.xml").read_text()
