"""The page on inspecting shows what the commands print: each is run, on the runs it speaks of."""

import re
import shlex
from pathlib import Path

from toy_bench import run_bench
from toy_pasts import past
from typer.testing import CliRunner

from executive.cli import main

PAGE = Path(__file__).parents[4] / "docs/inspecting.md"
SHOWN = re.compile(r"^```console\n\$ cellwright (.*?)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
TREE = re.compile(r"^```yaml\nroot:\n(.*?)^```$", re.MULTILINE | re.DOTALL)
LETTERS = {
    "good": {"door": "S", "look": "RRS", "grasp": "RRRF", "open": "S", "lift": "RRS"},
    "bad": {"door": "SSSSFS", "look": "RRSRS", "grasp": "RRRF", "open": "F", "lift": "S"},
}


def record_runs(folder, page):
    """Record the runs that the page speaks of: two of the examples, two of the worked story."""
    (folder / "runs").mkdir()
    example, story = TREE.findall(page)
    for name, letters in LETTERS.items():
        path = past(folder / "runs", example, letters, name=name, mission="pick").recording.path
        assert path.is_file()
    written = (folder / "runs/pick.yaml").read_text(encoding="utf-8")
    (folder / "edited.yaml").write_text(written.replace("width > 3", "width > 2"), encoding="utf-8")
    before = story.replace("age < 10", "age < 1")
    assert before != story
    assert outcome(run_bench(folder, before, "runs/monday")) == "success"
    (folder / "harness.yaml").rename(folder / "mended.yaml")
    assert outcome(run_bench(folder, story, "runs/tuesday")) == "failure"


def outcome(run):
    return run.recording.result.report.outcome


def shown(command):
    """Return what a command prints."""
    return CliRunner().invoke(main.app, shlex.split(command)).output


def test_every_command_of_the_page_prints_what_the_page_shows(tmp_path, monkeypatch):
    page = PAGE.read_text(encoding="utf-8")
    record_runs(tmp_path, page)
    monkeypatch.chdir(tmp_path)
    found = SHOWN.findall(page)
    assert len(found) > 15
    for command, expected in found:
        printed = "".join(f"{line.rstrip()}\n" for line in shown(command).splitlines())
        assert printed == expected, command


def test_the_story_takes_fewer_than_ten_commands_and_its_pictures_are_there():
    page = PAGE.read_text(encoding="utf-8")
    story = page[page.index("## A mission that fails") :]
    commands = len(SHOWN.findall(story)) + story.count("`cellwright inspect")
    assert commands < 10
    pictures = re.findall(r"\]\((images/\S+\.png)\)", story)
    assert len(pictures) >= 2
    for picture in pictures:
        assert (PAGE.parent / picture).stat().st_size < 200_000
