"""The page on skills: its examples run, one after the other, and it speaks of all that there is."""

import inspect
import re
from pathlib import Path

import pytest

from executive.core.skill import PausePolicy, Skill

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "skill_api.md").read_text(encoding="utf-8")
SNIPPETS = re.findall(r"^```python\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)


def test_the_examples_of_the_page_run():
    names = {"__name__": "skill_api"}
    for number, snippet in enumerate(SNIPPETS):
        exec(compile(snippet, f"docs/skill_api.md, example {number + 1}", "exec"), names)
    assert names["belt"].speed_m_s == 0.0
    assert sum("assert" in snippet for snippet in SNIPPETS) >= 4


@pytest.mark.parametrize("word", [name for name in vars(Skill) if name.isupper()])
def test_every_class_attribute_of_a_skill_is_explained(word):
    assert f"`{word}`" in PAGE


def test_every_policy_and_hook_is_explained():
    hooks = [name for name, member in vars(Skill).items() if inspect.isfunction(member)]
    public = [name for name in hooks if not name.startswith("_")]
    assert [name for name in public if not re.search(rf"\b{name}\b", PAGE)] == []
    assert [one.name for one in PausePolicy if f"PausePolicy.{one.name}" not in PAGE] == []
