"""`cellwright cover`: which branches of a tree its runs have taken."""

import dataclasses
import json
from pathlib import Path
from typing import Annotated

import typer

from executive.cli.recordings import RunsArgument
from executive.core.errors import InputError
from executive.inspector.cover import Cover, cover_run, merged
from executive.inspector.cover_html import cover_html
from executive.inspector.cover_text import cover_lines
from executive.inspector.past import PastRun


def cover(
    recordings: RunsArgument,
    fail_under: Annotated[
        float | None,
        typer.Option(
            metavar="PERCENT", min=0.0, max=100.0, help="Exit with 1 when less is covered."
        ),
    ] = None,
    html: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the YAML with its lines coloured.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON on stdout.")] = False,
) -> None:
    """Say which branches of a tree its runs have taken together, and which never were."""
    found = merged(cover_run(PastRun.open(path)) for path in recordings)
    if html is not None:
        _write(html, cover_html(found))
    if as_json:
        typer.echo(json.dumps(_document(found)))
    else:
        for line in cover_lines(found):
            typer.echo(line)
    if fail_under is not None and found.percent < fail_under:
        typer.echo(f"{found.percent:.1f} % is under {fail_under:g} %", err=True)
        raise typer.Exit(1)


def _document(found: Cover) -> dict[str, object]:
    nodes = [dataclasses.asdict(node) | {"missing": list(node.missing)} for node in found.nodes]
    return {
        "mission": found.mission,
        "tree": found.tree,
        "runs": list(found.runs),
        "percent": found.percent,
        "covered": found.covered,
        "total": found.total,
        "nodes": nodes,
    }


def _write(file: Path, text: str) -> None:
    try:
        file.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(f"{file}: cannot be written: {error.strerror}") from None
