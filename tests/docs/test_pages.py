"""The documentation against what is there: links, commands, generated pages."""

import importlib.util
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import typer

from executive.cli.main import app
from executive.engine.language.block_models import KINDS

ROOT = Path(__file__).parents[2]
CELLWRIGHT = Path(sys.executable).with_name("cellwright")
DECISION_2 = ROOT / "docs/decisions/0002-py-trees-underneath.md"
YAML = re.MULTILINE | re.DOTALL
PAGES = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")])
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
FENCED = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)
GROUPS = "tree |perceive |train |affinity |campaign (?=faults|show|compare)"
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


def test_documents_in_pages_are_sound(tmp_path):
    blocks = [
        block
        for page in PAGES
        for block in re.findall(r"^```yaml\n(.*?)^```$", page.read_text(encoding="utf-8"), YAML)
        if block.startswith("format:")
    ]
    assert blocks
    for block in blocks:
        name = re.search(r"^(?:tree|mission|cell|stubs): (\w+)$", block, re.MULTILINE)[1]
        (tmp_path / f"{name}.yaml").write_text(block, encoding="utf-8")
    checked = subprocess.run(
        [CELLWRIGHT, "check", *tmp_path.iterdir()], capture_output=True, text=True, check=False
    )
    assert checked.returncode == 0, checked.stdout


def test_the_page_on_trees_knows_every_kind_of_node():
    page = (ROOT / "docs/trees.md").read_text(encoding="utf-8")
    assert [kind for kind in KINDS if f"| `{kind}`" not in page and f", `{kind}`" not in page] == []


def test_traps_that_comments_name_are_written_down():
    listed = set(re.findall(r"^\| (e\d+) \|", DECISION_2.read_text(encoding="utf-8"), re.MULTILINE))
    comments = "".join(path.read_text(encoding="utf-8") for path in ROOT.glob("executive/**/*.py"))
    named = set(re.findall(r"\be\d+\b", " ".join(re.findall(r"\(traps? ([^)]*)\)", comments))))
    assert named
    assert named - listed == set()


def message_parts(heading: str) -> list[str]:
    """Return the words of a message that never differ; capitals stand for what does."""
    message = re.sub(r"'[A-Z]+'|\b[A-Z]+\b(?!_)", "\0", heading)
    parts = (part.strip(" ,;?.()") for part in message.split("\0"))
    return [part for part in parts if len(part) > 3]


def test_messages_of_the_troubleshooting_page_are_in_the_code():
    packages = [path.parent for path in ROOT.glob("*/__init__.py")]
    sources = [path for package in packages for path in package.glob("**/*.py")]
    text = "".join(path.read_text(encoding="utf-8") for path in [*sources, ROOT / "Makefile"])
    text = re.sub(r"""["']\s*\n\s*f?["']""", "", text).replace("{{", "{").replace("}}", "}")
    page = (ROOT / "docs/troubleshooting.md").read_text(encoding="utf-8")
    messages = re.findall(r"^### `(.+)`$", page, re.MULTILINE)
    assert len(messages) > 10
    parts = [part for message in messages for part in message_parts(message)]
    assert [part for part in parts if part not in text] == []


@pytest.mark.parametrize("name", ["skills", "models"])
def test_generated_pages_are_current(name):
    page = subprocess.run(
        [sys.executable, f"docs/{name}_page.py"],
        cwd=ROOT, capture_output=True, text=True, check=True,
    ).stdout  # fmt: skip
    assert (ROOT / f"docs/{name}.md").read_text(encoding="utf-8") == page, "say: make pages"


def options_of(*names: str) -> set[str]:
    """Return the options of a command of `cellwright`."""
    command: Any = typer.main.get_command(app)
    for name in names:
        command = command.get_command(None, name)
        assert command is not None, f"cellwright {' '.join(names)}: no such command"
    given = {word for each in command.params for word in (*each.opts, *each.secondary_opts)}
    return given | {"--help"}


def test_commands_and_their_options_exist():
    spoken: dict[tuple[str, ...], set[str]] = {}
    for line in (line for page in PAGES for line in commands(page)):
        found = re.match(
            rf"(?:\S*/)?cellwright (?:--path \S+ )?((?:{GROUPS})?[a-z][a-z-]*)\b(.*)", line
        )
        if found:
            # What follows `campaign` is the file of one that is run, if it is no other word.
            names = tuple(found[1].split()) if found[1] != "campaign" else ("campaign", "run")
            spoken.setdefault(names, set()).update(re.findall(r"--[a-z-]+", found[2]))
    assert spoken
    unknown = {names: used - options_of(*names) for names, used in spoken.items()}
    assert {names: used for names, used in unknown.items() if used} == {}
