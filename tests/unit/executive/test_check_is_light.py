"""What `check` imports and builds: no more than the files that it looks at ask for."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from executive.core.errors import InputError
from executive.core.registry import LazyRegistry
from executive.engine.loading.library import packaged_trees

SCRIPT = """
import json, sys
sys.argv = ["cellwright", *sys.argv[1:]]
from executive.cli.main import main
try:
    main()
except SystemExit:
    pass
from executive.engine.language.block_models import BLOCKS, LEAVES
built = [kind for kind, model in {**LEAVES, **BLOCKS}.items() if model.__pydantic_complete__]
print(json.dumps([sorted(sys.modules), built]), file=sys.stderr)
"""
SLOW = ("mcap", "networkx", "py_trees", "rich.console", "scipy", "zstandard", "zmq", "hypothesis")


def looked_at(*arguments):
    """Return the modules that a command has imported, and the kinds of nodes that it has built."""
    ended = subprocess.run(
        [sys.executable, "-c", SCRIPT, *map(str, arguments)],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    modules, built = json.loads(ended.stderr.splitlines()[-1])
    return set(modules), set(built)


@pytest.mark.parametrize("command", ["check", "lint"])
def test_looking_at_all_trees_loads_nothing_slow(command):
    modules, _ = looked_at(command, packaged_trees())
    assert [name for name in SLOW if name in modules] == []
    assert "skills.motion.go_home" in modules


def test_only_what_a_file_names_is_imported_and_built(tmp_path):
    file = tmp_path / "t.yaml"
    file.write_text("format: 1\ntree: t\nin: {a: {type: bool}}\nroot: {when: a}\n")
    modules, built = looked_at("check", file)
    assert built == {"when"}
    assert [name for name in modules if name.startswith(("skills.", "perception"))] == []
    assert "numpy" not in modules


def test_fmt_asks_for_no_skill(tmp_path):
    file = tmp_path / "t.yaml"
    file.write_text("format: 1\ntree: t\nroot: {skill: go_home}\n")
    modules, _ = looked_at("fmt", file)
    assert [name for name in modules if name.startswith(("skills", "numpy"))] == []


def test_things_are_imported_when_they_are_asked_for():
    registry = LazyRegistry("codec", {"json": "json:dumps", "other": "json:nothing"})
    assert [*registry] == ["json", "other"]
    assert registry.get("json") is json.dumps
    registry.add("path", Path)
    assert (len(registry), "path" in registry, registry.get("path")) == (3, True, Path)
    with pytest.raises(ValueError, match="'json' is registered twice"):
        registry.add("json", json.loads)
    with pytest.raises(ValueError, match="'path' is registered twice"):
        registry.add("path", Path)
    with pytest.raises(InputError, match="unknown codec 'jsn'; did you mean 'json'"):
        registry.get("jsn")
