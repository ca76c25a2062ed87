"""The page on dependencies has every package that is asked for, and no other."""

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
PAGE = (ROOT / "docs/dependencies.md").read_text(encoding="utf-8")


def names(requirements):
    return {re.match(r"[\w-]+", one)[0] for one in requirements}


def packages(column):
    """Return the packages that a column of a table names, by the first cell of their rows."""
    rows = [line.split("|")[1:-1] for line in PAGE.splitlines() if line.startswith("| `")]
    return [(row[0].strip("` *"), set(re.findall(r"`([\w-]+)`", row[column]))) for row in rows]


def test_every_package_has_its_reason():
    plain = [found for _, found in packages(0)]
    extras = PROJECT["optional-dependencies"]
    assert set().union(*plain) - set(extras) == names(PROJECT["dependencies"])


def test_every_extra_has_its_packages_and_their_reason():
    told = {}
    for extra, found in packages(1):
        if extra in PROJECT["optional-dependencies"]:
            told.setdefault(extra, set()).update(found)
    assert told == {
        extra: names(found) for extra, found in PROJECT["optional-dependencies"].items()
    }
