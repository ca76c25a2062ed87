"""What runs have covered, as one page: the YAML files with their lines coloured."""

from collections.abc import Iterator, Sequence
from html import escape
from pathlib import PurePath

from executive.engine.recording.messages import SourceFile
from executive.inspector.cover import Cover, NodeCover, by_file
from executive.inspector.cover_text import missing_text

_STYLE = """
:root { color-scheme: light dark; --back: #ffffff; --text: #1f2328; --dim: #6b7280; --line: #e5e7eb;
  --all: #dcfce7; --some: #fef3c7; --none: #fee2e2; --allbar: #16a34a; --somebar: #d97706;
  --nonebar: #dc2626; }
@media (prefers-color-scheme: dark) { :root { --back: #14171c; --text: #e6e8eb; --dim: #9aa3af;
  --line: #2b3038; --all: #12321f; --some: #3a2d0c; --none: #3f1518; } }
body { background: var(--back); color: var(--text); font: 15px/1.5 system-ui, sans-serif;
  max-width: 76rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.4rem; margin: 0 0 .2rem; } h2 { font-size: 1.05rem; margin: 2rem 0 .5rem; }
.dim { color: var(--dim); } .big { font-size: 2.4rem; font-weight: 600; }
.bar { height: .5rem; border-radius: .25rem; background: var(--none); overflow: hidden;
  max-width: 24rem; } .bar i { display: block; height: 100%; background: var(--allbar); }
.legend span { display: inline-block; padding: 0 .6rem; margin-right: .5rem; border-radius: .2rem; }
.code { border: 1px solid var(--line); border-radius: .4rem; overflow-x: auto; }
table { border-collapse: collapse; width: 100%;
  font: 13px/1.55 ui-monospace, SFMono-Regular, Menlo, monospace; }
td { padding: 0 .6rem; vertical-align: top; white-space: pre; }
td.n { color: var(--dim); text-align: right; user-select: none; width: 1%; }
td.c { color: var(--dim); text-align: right; width: 1%; }
td.m { color: var(--dim); white-space: normal; font-family: system-ui, sans-serif;
  min-width: 16rem; max-width: 26rem; }
.all { background: var(--all); } .some { background: var(--some); }
.none { background: var(--none); }
tr.all td.n { border-left: 4px solid var(--allbar); } tr.some td.n { border-left: 4px solid
  var(--somebar); } tr.none td.n { border-left: 4px solid var(--nonebar); }
tr.plain td.n { border-left: 4px solid transparent; }
"""


def cover_html(cover: Cover) -> str:
    """Return a page that needs nothing else, light or dark as its reader likes it."""
    runs = "".join(f"<li>{escape(run)}</li>" for run in cover.runs)
    nodes = by_file(cover)
    files = "".join(_file(source, nodes.get(source.file, ())) for source in cover.sources)
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{escape(cover.mission)}: {cover.percent:.0f} % covered</title>"
        f"<style>{_STYLE}</style></head><body>"
        f"<h1>{escape(cover.mission)}</h1>"
        f'<div class="big">{cover.percent:.0f} %</div>'
        f'<div class="bar"><i style="width:{cover.percent:.1f}%"></i></div>'
        f"<p>{cover.covered} of {cover.total} branches taken in {len(cover.runs)} runs "
        f'<span class="dim">(tree {cover.tree})</span></p>'
        '<p class="legend"><span class="all">all branches</span><span class="some">some</span>'
        '<span class="none">never ran</span></p>'
        f"<details><summary>Runs</summary><ul>{runs}</ul></details>{files}</body></html>\n"
    )


def _file(source: SourceFile, nodes: Sequence[NodeCover]) -> str:
    covered, total = sum(n.covered for n in nodes), sum(len(n.taken) for n in nodes)
    rows = "".join(_rows(source.text, nodes))
    name = escape(PurePath(source.file).name)
    return (
        f'<h2>{name} <span class="dim">{covered} of {total} branches</span></h2>'
        f'<div class="code"><table>{rows}</table></div>'
    )


def _rows(text: str, nodes: Sequence[NodeCover]) -> Iterator[str]:
    for number, line in enumerate(text.splitlines(), start=1):
        here = [node for node in nodes if node.line == number]
        started = sum(node.started for node in here)
        count = f"{started} x" if here else ""
        yield (
            f'<tr class="{_shade(here)}"><td class="n">{number}</td><td class="c">{count}</td>'
            f'<td>{escape(line)}</td><td class="m">{_missing(here)}</td></tr>'
        )


def _shade(nodes: Sequence[NodeCover]) -> str:
    if not nodes:
        return "plain"
    if not any(node.started for node in nodes):
        return "none"
    return "some" if any(node.missing for node in nodes) else "all"


def _missing(nodes: Sequence[NodeCover]) -> str:
    missing = [node for node in nodes if node.missing]
    if not any(node.started for node in nodes):
        return "never ran" if missing else ""
    several = len(nodes) > 1
    texts = (f"{n.path}: {missing_text(n)}" if several else missing_text(n) for n in missing)
    return escape(f"not taken: {'; '.join(texts)}") if missing else ""
