"""`cellwright retick`: whether a tree decides again as it did, from what its skills answered."""

import json
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from executive.app.catalogue import port_types
from executive.cli.console import results
from executive.cli.recordings import RunArgument
from executive.inspector.past import PastRun
from executive.inspector.retick.retick import Retick
from executive.inspector.retick.retick import retick as ticked_again
from executive.inspector.retick.text import retick_document, retick_lines


class BeyondAnswer(StrEnum):
    """What skills answer outside the recording."""

    RUNNING = "running"
    SUCCESS = "success"
    FAILURE = "failure"


Beyond = Annotated[
    BeyondAnswer | None,
    typer.Option(
        help="What a skill answers in a tick in which the recording has no answer of it; without "
        "this, ticking again ends there."
    ),
]


def retick(
    recording: RunArgument,
    tree: Annotated[
        list[Path] | None,
        typer.Option(metavar="FILE", help="Edited tree or mission; may be given several times."),
    ] = None,
    beyond: Beyond = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON on stdout.")] = False,
) -> None:
    """Tick a run again with what its skills answered: where would the tree decide otherwise?

    Needs no cell and no skill. Exits with 0 when every tick is as it was, with 1 when not.
    """
    run = PastRun.open(recording)
    found = ticked_again(
        run, port_types(), edited=tree or (), beyond=beyond.value if beyond else None
    )
    print_and_exit(run, found, as_json=as_json)


def print_and_exit(run: PastRun, found: Retick, *, as_json: bool) -> None:
    """Print what came of ticking a run again, and exit with what that comes to."""
    if as_json:
        typer.echo(json.dumps(retick_document(found)))
    else:
        console = results()
        for line in retick_lines(found, run):
            console.print(line, soft_wrap=True)
    raise typer.Exit(int(not found.identical))
