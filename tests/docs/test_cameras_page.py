"""The page on cameras: its examples run, one after the other."""

import re
from pathlib import Path

PAGE = (Path(__file__).parents[2] / "docs" / "cameras.md").read_text(encoding="utf-8")


def test_the_examples_of_the_page_run():
    names = {"__name__": "cameras"}
    for number, snippet in enumerate(re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)):
        exec(compile(snippet, f"docs/cameras.md, example {number + 1}", "exec"), names)
    assert names["frame"].image.max() == 200
