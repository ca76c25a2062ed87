"""`cellwright diff`: where two runs first went apart, and because of what."""

import dataclasses
import json
from pathlib import Path
from typing import Annotated

import typer

from executive.cli.console import results
from executive.cli.recordings import recording_argument
from executive.inspector.diff import DiffKind, diff_runs
from executive.inspector.diff_text import diff_lines
from executive.inspector.past import PastRun


def diff(
    a: Annotated[Path, recording_argument("A", "Recording that is held to be right")],
    b: Annotated[Path, recording_argument("B", "Recording that is held against it")],
    ignore_values: Annotated[
        list[str] | None,
        typer.Option(metavar="GLOB", help="Keys or fields whose values count as equal: trace.p*."),
    ] = None,
    fail_on: Annotated[
        DiffKind,
        typer.Option(help="Exit with 1 for this, and for what is worse: timing, value, outcome."),
    ] = DiffKind.TIMING,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON on stdout.")] = False,
) -> None:
    """Say where two runs first differ, aligned by what happened and not by tick numbers.

    Exits with 0 when they are equal, with 1 when they differ.
    """
    run = PastRun.open(a)
    found = diff_runs(run, PastRun.open(b), ignore_values or ())
    differs = found.differs(fail_on)
    if as_json:
        typer.echo(json.dumps({"differ": differs, **dataclasses.asdict(found)}))
    else:
        console = results()
        for line in diff_lines(found, run):
            console.print(line, soft_wrap=True)
    raise typer.Exit(int(differs))
