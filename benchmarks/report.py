"""docs/results.md from the committed result files; nobody edits the page by hand."""

import json
from pathlib import Path

from benchmarks.harness import RESULTS

PAGE = Path(__file__).parent.parent / "docs" / "results.md"
HEAD = """# Results

Every figure here was measured by the command above its table, and written by
`python -m benchmarks report` from the files in `benchmarks/results/`. The interval holds
95 %. The machines are shared and noisy: ratios are paired in one run, absolute times are
those of two cores.
"""


def write_page() -> Path:
    """Write the page and return where it is."""
    documents = [
        json.loads(path.read_text(encoding="utf-8")) for path in sorted(RESULTS.glob("*.json"))
    ]
    full = [document for document in documents if not document["quick"]]
    PAGE.write_text("\n".join([HEAD, *(_section(document) for document in full)]), "utf-8")
    return PAGE


def _section(document: dict[str, object]) -> str:
    name, seed = document["benchmark"], document["seed"]
    rows = document["rows"]
    assert isinstance(rows, list)
    lines = [
        f"## {name}",
        "",
        f"`python -m benchmarks {name} --seed {seed}`, commit {document['commit']}",
        "",
        "| figure | value | unit | n | 95 % interval | goal |",
        "|---|---|---|---|---|---|",
        *(_line(row) for row in rows),
        "",
    ]
    return "\n".join(lines)


def _line(row: dict[str, object]) -> str:
    low, high = float(str(row["low"])), float(str(row["high"]))
    value = float(str(row["value"]))
    cells = (row["name"], f"{value:.4g}", row["unit"], row["n"], f"{low:.3g} .. {high:.3g}")
    return f"| {' | '.join(str(cell) for cell in cells)} | {row['goal']} |"
