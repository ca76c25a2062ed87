"""The page on language models: its example runs."""

import re
from pathlib import Path

PAGE = (Path(__file__).parents[2] / "docs" / "language_models.md").read_text(encoding="utf-8")


def test_the_example_of_the_page_runs():
    names = {"__name__": "language_models"}
    for snippet in re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL):
        exec(compile(snippet, "docs/language_models.md", "exec"), names)
    assert names["matrix"].names == names["names"]
