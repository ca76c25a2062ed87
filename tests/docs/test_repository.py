"""What may not enter the repository: large files, and paths of one machine."""

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MAX_BYTES = 2_000_000
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
    large = {str(path): path.stat().st_size for path in tracked_files()}
    assert {name: size for name, size in large.items() if size > MAX_BYTES} == {}


def test_no_file_names_a_path_of_one_machine():
    named = {
        str(path.relative_to(ROOT)): found.group()
        for path in tracked_files()
        if path != Path(__file__) and (found := ABSOLUTE_PATH.search(text_of(path)))
    }
    assert named == {}


def test_every_package_that_is_asked_for_is_pinned():
    asked = re.findall(r'^    "([\w-]+)[>=<]', (ROOT / "pyproject.toml").read_text(), re.MULTILINE)
    lines = (ROOT / "constraints.txt").read_text().splitlines()
    pinned = {line.split("==")[0].lower().replace("_", "-") for line in lines if "==" in line}
    assert asked
    assert [name for name in asked if name.lower().replace("_", "-") not in pinned] == []
