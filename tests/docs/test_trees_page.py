"""The rules of the language against the tests that they name."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "trees.md").read_text(encoding="utf-8")
TESTS = ROOT / "tests" / "unit" / "executive" / "engine"


def rules() -> dict[int, str]:
    """Return the text of every rule by its number."""
    found = re.split(r"^(\d+)\. ", PAGE, flags=re.MULTILINE)[1:]
    return {int(number): text for number, text in zip(found[::2], found[1::2], strict=True)}


def named_in(text: str) -> set[str]:
    """Return the tests that a text names."""
    return set(re.findall(r"`(test_\w+)`", text))


def test_rules_are_numbered_without_gaps():
    assert list(rules()) == list(range(1, len(rules()) + 1))


def test_every_rule_names_a_test():
    assert [number for number, text in rules().items() if not named_in(text)] == []


def test_every_test_that_is_named_exists():
    source = "".join(file.read_text(encoding="utf-8") for file in TESTS.glob("test_*.py"))
    assert named_in(PAGE) - set(re.findall(r"^def (test_\w+)", source, re.MULTILINE)) == set()
