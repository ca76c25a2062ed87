"""`cellwright whatif`: what a tree would have decided with another value, or another answer."""

from typing import Annotated

import typer

from executive.app.catalogue import port_types
from executive.cli.cmd_retick import Beyond, print_and_exit
from executive.cli.recordings import RunArgument
from executive.inspector.past import PastRun
from executive.inspector.retick.question import what_if
from executive.inspector.retick.retick import retick


def whatif(
    recording: RunArgument,
    at: Annotated[str, typer.Option(metavar="TICK", help="In which tick: 41, -1, last or 12.3s.")],
    values: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="Value of a key, or of a field: trace.probability=0.4.",
        ),
    ] = None,
    force: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NODE=STATUS", help="What a node answers in that tick: grasp=failure."
        ),
    ] = None,
    beyond: Beyond = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON on stdout.")] = False,
) -> None:
    """Tick a run again with another value, or another answer of a node, in one tick.

    Exits with 0 when every tick is as it was, with 1 when not.
    """
    run = PastRun.open(recording)
    question = what_if(run, at, values or (), force or ())
    found = retick(run, port_types(), what_if=question, beyond=beyond.value if beyond else None)
    print_and_exit(run, found, as_json=as_json)
