"""The page on the service against the code: its commands work, and it names what there is."""

import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from urllib.error import URLError
from urllib.request import Request, urlopen

import pytest

from executive.app.service.cell_service import CellService
from executive.app.service.http import application
from executive.app.service.opcua import STATE_CODES

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "service.md").read_text(encoding="utf-8")
MISSION = re.search(r"```yaml\n(.*?)```", (DOCS / "campaigns.md").read_text(), re.DOTALL)[1]


def blocks():
    return re.findall(r"```sh\n(.*?)```", PAGE, re.DOTALL)


def asked(command, port):
    """Do what a line of curl does."""
    words = shlex.split(command)
    url = next(word for word in words if word.startswith("http")).replace("8420", str(port))
    data = words[words.index("-d") + 1].encode() if "-d" in words else None
    headers = {"content-type": "application/json"} if data else {}
    with urlopen(Request(url, data=data, headers=headers), timeout=30) as answer:
        return json.load(answer)


@pytest.fixture
def port(tmp_path):
    """Serve the cell as the page says, and return the port of HTTP."""
    (tmp_path / "fetch.yaml").write_text(MISSION)
    words = shlex.split(blocks()[0].replace("8420", "0").replace("4840", "0"))
    command = [str(Path(sys.executable).with_name("cellwright")), *words[1:]]
    # Locks of cells are there; a test beside this one may run a mission on the same cell. The path
    # of a socket has to be short, which that of tmp_path may not be.
    with (
        tempfile.TemporaryDirectory() as own,
        subprocess.Popen(
            command,
            cwd=tmp_path,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, "TMPDIR": own},
        ) as process,
    ):
        lines = iter(process.stderr.readline, "")
        found = next(m[1] for line in lines if (m := re.search(r"127\.0\.0\.1:(\d+)/open", line)))
        assert any("opc.tcp://127.0.0.1" in line for line in lines)
        yield int(found)
        process.terminate()
        process.communicate(timeout=60)
    assert (tmp_path / "runs" / "dry" / "missions.jsonl").exists()


def test_the_commands_do_what_is_said(port):
    post, mission, cell = blocks()[1].strip().splitlines()
    assert asked(post, port)["id"] == 1
    deadline = time.monotonic() + 60.0
    while asked(mission, port)["state"] != "done":
        assert time.monotonic() < deadline
        time.sleep(0.1)
    assert asked(mission, port)["report"]["seed"] == 3
    assert asked(cell, port)["last"] == 1
    with pytest.raises(URLError):
        asked(mission.replace("missions/1", "missions/2"), port)


def test_every_request_state_variable_and_method_is_named(tmp_path):
    service = CellService("any", tmp_path, tmp_path / "lock")
    document = application(service).openapi()
    ways = [f"{verb.upper()} {path}" for path, verbs in document["paths"].items() for verb in verbs]
    named = PAGE.replace("/1", "/{number}")
    assert [way for way in ways if f"`{way}" not in named] == []
    assert [name for name in STATE_CODES if f"`{name}`" not in PAGE] == []
    assert all(f"{code} {name}" in PAGE for name, code in STATE_CODES.items())
    source = Path(sys.modules[application.__module__].__file__).with_name("opcua.py").read_text()
    names = re.findall(r"[A-Z]\w+", source.split('"""')[1].partition("Objects/Cellwright\n")[2])
    skipped = {"Id", "Error", "Settings", "Key", "Seed", "LGPL"}
    assert [name for name in names if name not in skipped and f"`{name}`" not in PAGE] == []
