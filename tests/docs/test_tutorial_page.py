"""The tutorial, done step by step as it says."""

import re
import shlex
from pathlib import Path

from typer.testing import CliRunner

from executive.cli.main import app

PAGE = (Path(__file__).parents[2] / "docs" / "tutorial.md").read_text(encoding="utf-8")
STEP = re.compile(r"```(yaml|console)\n(.*?)```", re.DOTALL)


def cellwright(command):
    return CliRunner().invoke(app, shlex.split(command)[1:])


def said(text):
    """Return lines without what differs from run to run: times of this machine."""
    return [re.sub(r"[\d.]+ s here", "", line).rstrip() for line in text.strip().splitlines()]


def test_every_step_gives_what_is_shown(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shown = 0
    for language, block in STEP.findall(PAGE):
        if language == "yaml":
            name = re.search(r"^(?:campaign|stubs|mission): (\w+)$", block, re.MULTILINE)[1]
            Path(f"{name}.yaml").write_text(block)
            continue
        command, _, output = block.removeprefix("$ ").partition("\n")
        result = cellwright(command)
        assert said(result.stdout) == said(output), result.output
        shown += 1
    assert shown == 5
    compared = cellwright("cellwright diff first.mcap second.mcap")
    assert "differ" in compared.stdout
    assert cellwright("cellwright lint load_press.yaml").exit_code == 0
    assert cellwright("cellwright inspect first.mcap --plain").exit_code == 0


def test_the_campaign_of_the_tutorial_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    blocks = [block for language, block in STEP.findall(PAGE) if language == "yaml"]
    stubs, _, mission, campaign = blocks
    chance = "                - {chance: 0.5, name: holds}\n"
    pick = "                - {skill: pick, in: {place: $place}}\n"
    assert pick in mission
    missed = "      - {outcome: failure, ticks: 4, reason: grasp.missed}\n"
    assert missed in stubs
    Path("press_stubs.yaml").write_text(stubs.replace(missed, ""))
    Path("load_press.yaml").write_text(mission.replace(pick, pick + chance))
    Path("load.yaml").write_text(campaign)
    commands = re.findall(r"^cellwright campaign .*$", PAGE, re.MULTILINE)
    first, second = (cellwright(command) for command in commands)
    assert first.exit_code == 0, first.output
    assert "40 runs" in first.stdout
    assert second.exit_code in (0, 1), second.output
    assert "success" in second.stdout
