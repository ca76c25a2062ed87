"""The documentation against what is there: links, make words, modules."""

import importlib.util
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")])
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
FENCED = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)
CODE = re.compile(r"^```sh\n(.*?)^```$|`([^`\n]+)`", re.MULTILINE | re.DOTALL)


def page_id(page: Path) -> str:
    """Return a page's path, for the names of tests."""
    return str(page.relative_to(ROOT))


def anchors(page: Path) -> set[str]:
    """Return the anchors of a page's headings, as code hosts make them."""
    text = FENCED.sub("", page.read_text(encoding="utf-8"))
    titles = re.findall(r"^#+ (.+)$", text, re.MULTILINE)
    bare = (re.sub(r"[^\w\- ]", "", title.lower()) for title in titles)
    return {title.replace(" ", "-") for title in bare}


def commands(page: Path) -> list[str]:
    """Return what a page tells people to type: shell blocks and inline code, by line."""
    found = CODE.findall(page.read_text(encoding="utf-8"))
    lines = (line for block in found for part in block for line in part.splitlines())
    return [line.split("#")[0].strip() for line in lines]


@pytest.mark.parametrize("page", PAGES, ids=page_id)
def test_links_resolve(page):
    text = FENCED.sub("", page.read_text(encoding="utf-8"))
    broken = []
    for link in LINK.findall(text):
        target, _, anchor = link.partition("#")
        path = (page.parent / target) if target else page
        if target.startswith("http"):
            continue
        if not path.exists() or (anchor and anchor not in anchors(path)):
            broken.append(link)
    assert broken == []


@pytest.mark.parametrize("page", PAGES, ids=page_id)
def test_make_words_exist(page):
    words = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    named = [line.split()[1] for line in commands(page) if re.match(r"make [a-z-]+$", line)]
    assert [word for word in named if word not in words] == []


@pytest.mark.parametrize("page", PAGES, ids=page_id)
def test_modules_to_run_exist(page):
    named = [found for line in commands(page) for found in re.findall(r"python -m ([\w.]+)", line)]
    assert [name for name in named if importlib.util.find_spec(name) is None] == []
