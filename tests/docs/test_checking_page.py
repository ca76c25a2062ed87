"""The page on check, lint and fmt against what the commands do."""

import re
from pathlib import Path

from executive.engine.lint.rules import RULES, WAIVER_CODE
from executive.engine.lint.shape_rules import DEEP

PAGE = (Path(__file__).parents[2] / "docs" / "checking.md").read_text(encoding="utf-8")


def test_every_rule_has_its_section_in_order_and_no_other_has():
    titles = re.findall(r"^### (L\d+ .+)$", PAGE, re.MULTILINE)
    assert titles == [f"{rule.code} {rule.name}" for rule in RULES]
    assert f"`{WAIVER_CODE}`" in PAGE


def test_numbers_on_the_page_are_those_of_the_rules():
    assert f"More than {DEEP} levels" in PAGE
