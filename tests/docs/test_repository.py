"""What may not enter the repository, and that it asks for what it uses."""

import ast
import importlib.metadata
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MAX_BYTES = 2_000_000
MOST_OF_WEIGHTS, ALL_WEIGHTS = 30_000_000, 80_000_000
# Import names whose distribution says nothing of them, or is a part of another one.
OWNERS = {
    "coal": ["pin"],
    "pinocchio": ["pin"],
    "pydantic_core": ["pydantic"],
    "rerun": ["rerun-sdk"],
}
ABSOLUTE_PATH = re.compile(r"(?<![\w.~<])/(?:home|root|tmp|work|Users)/[\w.]")


def tracked_files() -> list[Path]:
    """Return the files that git tracks, and those that it would add."""
    listing = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    if listing.returncode != 0:
        pytest.skip("not a git checkout")
    paths = (ROOT / name for name in listing.stdout.split("\0") if name)
    return [path for path in paths if path.is_file()]


def text_of(path: Path) -> str:
    """Return the text of a file, empty for a binary one."""
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return ""


def test_no_file_is_large():
    sizes = {path: path.stat().st_size for path in tracked_files()}
    weights = {path: size for path, size in sizes.items() if path.suffix == ".safetensors"}
    others = {path: size for path, size in sizes.items() if path not in weights}
    assert {path.name: size for path, size in others.items() if size > MAX_BYTES} == {}
    assert {path.name: size for path, size in weights.items() if size > MOST_OF_WEIGHTS} == {}
    assert sum(weights.values()) <= ALL_WEIGHTS


def test_no_file_names_a_path_of_one_machine():
    named = {
        str(path.relative_to(ROOT)): found.group()
        for path in tracked_files()
        if path != Path(__file__) and (found := ABSOLUTE_PATH.search(text_of(path)))
    }
    assert named == {}


def asked_for() -> set[str]:
    """Return the distributions that the installed package asks for."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    wanted = sum(project["optional-dependencies"].values(), start=project["dependencies"])
    return {canonical(re.split(r"[>=<]", each)[0]) for each in wanted}


def canonical(name: str) -> str:
    """Return a distribution's name as package indexes compare it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def imported(path: Path) -> set[str]:
    """Return the top-level names that a module imports."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names.add(node.module.split(".")[0])
    return names


def test_every_package_that_is_asked_for_is_pinned():
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    pinned = {canonical(line.split("==")[0]) for line in lines if "==" in line}
    assert asked_for() - pinned == set()


def test_everything_that_is_imported_is_asked_for():
    modules = [path for path in tracked_files() if path.suffix == ".py"]
    own = {path.parent.name for path in ROOT.glob("*/__init__.py")} | {
        path.stem for path in modules
    }
    others = set().union(*map(imported, modules)) - own - sys.stdlib_module_names
    owners = importlib.metadata.packages_distributions() | OWNERS
    asked = asked_for()
    unasked = {
        name for name in others if not asked.intersection(map(canonical, owners.get(name, [name])))
    }
    assert unasked == set()
