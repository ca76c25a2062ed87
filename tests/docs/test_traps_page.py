"""The traps and complaints against the tests that close them."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "traps.md").read_text(encoding="utf-8")
DECISION = (ROOT / "docs/decisions/0002-py-trees-underneath.md").read_text(encoding="utf-8")


def rows():
    """Return the rows of both tables by their first cell."""
    found = re.findall(r"^\| (e\d+|XML|\d+) \|(.*)$", PAGE, re.MULTILINE)
    return dict(found)


def names_of_tests():
    files = (ROOT / "tests").rglob("test_*.py")
    source = "".join(file.read_text(encoding="utf-8") for file in files)
    return set(re.findall(r"^def (test_\w+)", source, re.MULTILINE))


def test_every_trap_of_the_decision_and_all_complaints_have_a_row():
    named = set(re.findall(r"^\| (e\d+) \|", DECISION, re.MULTILINE))
    assert named - set(rows()) == set()
    assert [number for number in range(1, 16) if str(number) not in rows()] == []


def test_every_row_names_a_test():
    assert [row for row, text in rows().items() if "`test_" not in text] == []


def test_every_test_of_a_trap_exists():
    assert set(re.findall(r"`(test_\w+)`", PAGE)) - names_of_tests() == set()
