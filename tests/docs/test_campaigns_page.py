"""The page on campaigns against the code: its examples give what is shown."""

import re
import shlex
from pathlib import Path

from typer.testing import CliRunner

from executive.app.campaigns.document import CampaignDocument, Draw, Limits
from executive.app.campaigns.jobs import LOST
from executive.cli.main import app

PAGE = (Path(__file__).parents[2] / "docs" / "campaigns.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)


def said(text):
    """Return lines without what differs from machine to machine, and in the last digit of p."""
    lines = [line for line in text.strip().splitlines() if not line.startswith("  wall_s")]
    return [re.sub(r" +", " ", line).rstrip() for line in lines]


def test_the_examples_give_what_is_shown(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    mission, campaign = blocks("yaml")
    Path("fetch.yaml").write_text(mission)
    Path("tries.yaml").write_text(campaign)
    for block in blocks("console"):
        command, _, shown = block.removeprefix("$ ").partition("\n")
        result = CliRunner().invoke(app, shlex.split(command)[1:])
        assert said(result.stdout) == said(shown), result.output
    listed = CliRunner().invoke(app, ["campaign", "tries.yaml", "--list"])
    assert "80 runs: each with 40 seeds, 0 to 39" in listed.stdout


def test_every_key_of_the_document_is_explained():
    keys = {field.alias or name for name, field in CampaignDocument.model_fields.items()}
    keys -= {"format", "campaign", "about"}
    assert [key for key in keys if f"| `{key}` |" not in PAGE] == []
    inner = [*Draw.model_fields, *Limits.model_fields]
    assert [key for key in inner if key not in PAGE] == []
    assert [word for word in LOST if f"| `{word}` |" not in PAGE] == []
