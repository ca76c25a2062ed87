"""The page on debugging: its mission is run, and its commands print what it shows."""

import re
import shlex
import subprocess
import sys
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

from executive.cli.main import app
from executive.engine.debugging.breakpoints import Event, parse_breakpoint

PAGE = (Path(__file__).parents[2] / "docs" / "debugging.md").read_text(encoding="utf-8")
SHOWN = re.compile(r"^```console\n\$ cellwright (.*?)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
STARTED = re.compile(r"^```sh\ncellwright (.*?)\n```$", re.MULTILINE)
FILES = re.compile(r"`(\w+\.yaml)`\n\n```yaml\n(.*?)^```$", re.MULTILINE | re.DOTALL)
BREAKPOINTS = re.findall(r"^\| `(.+?)` \|", PAGE, re.MULTILINE)
LIMIT_S = 20.0


def cellwright(command):
    return CliRunner().invoke(app, shlex.split(command))


def test_every_breakpoint_of_the_table_is_one():
    events = {parse_breakpoint(text).event for text in BREAKPOINTS}
    told = events | {Event(word) for word in re.findall(r"`(\w+)`", PAGE) if word in [*Event]}
    assert told == {*Event}


@pytest.fixture
def mission(tmp_path, monkeypatch):
    """Run the mission of the page in a process of its own, paused where the page says."""
    monkeypatch.chdir(tmp_path)
    for name, text in FILES.findall(PAGE):
        (tmp_path / name).write_text(text, encoding="utf-8")
    command = [str(Path(sys.executable).with_name("cellwright"))]
    command += shlex.split(STARTED.search(PAGE)[1])
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        end_s = time.monotonic() + LIMIT_S
        while "paused" not in cellwright("attach runs/pick.mcap --do state").stdout:
            assert time.monotonic() < end_s
            time.sleep(0.05)
        yield process
        process.kill()


def test_the_commands_print_what_the_page_shows(mission):
    for command, expected in SHOWN.findall(PAGE):
        assert cellwright(command).stdout == expected, command
    assert "pick/place: debug.forced" in mission.communicate(timeout=LIMIT_S)[0]
