"""docs/results.md from the committed result files; nobody edits the page by hand."""

import json
from collections.abc import Iterator, Sequence
from pathlib import Path

from benchmarks.goals import parse_goal
from benchmarks.harness import RESULTS
from benchmarks.pictures import IMAGES, PICTURES

PAGE = Path(__file__).parent.parent / "docs" / "results.md"
HEAD = """# Results

Every figure here was measured by the command above its table, and written by
`python -m benchmarks report` from the files in `benchmarks/results/`. The interval holds
95 %. The machines are shared and noisy: ratios are paired in one run, absolute times are
those of two cores. The first table says where goals are met, the second what falls short.
"""

Document = dict[str, object]


def write_page() -> Path:
    """Write the page and return where it is."""
    documents = [
        json.loads(path.read_text(encoding="utf-8")) for path in sorted(RESULTS.glob("*.json"))
    ]
    full = [document for document in documents if not document["quick"]]
    PAGE.write_text(
        "\n".join([HEAD, _goals(full), *(_section(document) for document in full)]), "utf-8"
    )
    return PAGE


def _goals(documents: Sequence[Document]) -> str:
    """Return how many goals each benchmark meets, and each figure that falls short."""
    met, short = list[str](), list[str]()
    for document in documents:
        judged = list(_judged(document))
        missed = [row for row, is_met in judged if not is_met]
        name = document["benchmark"]
        if judged:
            met.append(f"| [{name}](#{name}) | {len(judged) - len(missed)} | {len(judged)} |")
        short += [f"| {name} | {' | '.join(_cells(row))} |" for row in missed]
    lines = [
        *("## Goals", "", "| benchmark | goals met | of |", "|---|---|---|", *met, ""),
        *("| benchmark | falls short | value | unit | n | 95 % interval | goal |",),
        *("|---|---|---|---|---|---|---|", *short, ""),
    ]
    return "\n".join(lines)


def _judged(document: Document) -> Iterator[tuple[Document, bool]]:
    """Yield the rows that have a goal, and whether they meet it."""
    for row in _rows(document):
        goal = parse_goal(str(row["goal"]))
        if goal is not None:
            yield row, goal.is_met(float(str(row["value"])))


def _rows(document: Document) -> list[Document]:
    rows = document["rows"]
    assert isinstance(rows, list)
    return rows


def _section(document: Document) -> str:
    name, seed = document["benchmark"], document["seed"]
    lines = [
        f"## {name}",
        "",
        f"`python -m benchmarks {name} --seed {seed}`, commit {document['commit']}",
        "",
        *_picture(str(name)),
        "| figure | value | unit | n | 95 % interval | goal |",
        "|---|---|---|---|---|---|",
        *(f"| {' | '.join(_cells(row))} |" for row in _rows(document)),
        "",
    ]
    return "\n".join(lines)


def _picture(benchmark: str) -> Iterator[str]:
    """Yield the lines that show the picture of a benchmark, where there is one."""
    picture = PICTURES.get(benchmark)
    if picture is not None and (IMAGES / picture.file).exists():
        yield f"![{picture.about}](images/{picture.file})"
        yield ""
        yield f"*{picture.about}*"
        yield ""


def _cells(row: Document) -> list[str]:
    low, high = float(str(row["low"])), float(str(row["high"]))
    value = float(str(row["value"]))
    figures = (f"{value:.4g}", row["unit"], row["n"], f"{low:.3g} .. {high:.3g}")
    return [str(cell) for cell in (row["name"], *figures, row["goal"])]
