"""`cellwright ticks`: what each tick of a recording changed."""

import json
from typing import Annotated

import typer
from rich.text import Text

from executive.cli.console import results
from executive.cli.recordings import RunArgument
from executive.core.errors import InputError
from executive.inspector.answer_view import ticks_document, ticks_lines
from executive.inspector.past import PastRun
from executive.inspector.search import search
from executive.inspector.tick_list import TickFilter, tick_list


def ticks(
    recording: RunArgument,
    node: Annotated[
        str | None, typer.Option(metavar="GLOB", help="Only nodes that match, by path or name.")
    ] = None,
    key: Annotated[str | None, typer.Option(metavar="GLOB", help="Only keys that match.")] = None,
    first: Annotated[
        str, typer.Option("--from", metavar="TICK", help="First tick: 41, -1, or 12.3s.")
    ] = "first",
    to: Annotated[str | None, typer.Option(metavar="TICK", help="Last tick.")] = None,
    where: Annotated[
        str | None,
        typer.Option(
            metavar="EXPRESSION",
            help="Only ticks at which this is true: trace.end == 'edge' and "
            "status('*dilate*') == RUNNING",
        ),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON lines on stdout.")] = False,
) -> None:
    """Say what each tick of a run changed; ticks that repeat each other are told once."""
    run = PastRun.open(recording)
    asked = _filter(run, node, key, (first, to), where)
    console = results()
    if where is not None and not as_json:
        count = len(asked.only or ())
        console.print(Text(f"{count} ticks of {len(run.index)} with {where}", "bold"))
    for told in tick_list(run.index, asked):
        if as_json:
            typer.echo(json.dumps(ticks_document(told)))
            continue
        for line in ticks_lines(run, told):
            console.print(line, soft_wrap=True)


def _filter(
    run: PastRun,
    node: str | None,
    key: str | None,
    limits: tuple[str, str | None],
    where: str | None,
) -> TickFilter:
    first = run.names.tick(limits[0])
    last = len(run.index) - 1 if limits[1] is None else run.names.tick(limits[1])
    if first > last:
        raise InputError(f"--from {limits[0]}: comes after --to {limits[1]}; expected it before")
    # Who asks for keys alone wants no nodes, and the other way round.
    nodes = frozenset(range(len(run.index.nodes))) if key is None else frozenset()
    if node is not None:
        nodes = frozenset(run.names.nodes(node))
    if key is not None:
        run.names.keys(key)
    keys = key if key is not None or node is None else ""
    found = None if where is None else search(run.index, where)
    only = None if found is None else frozenset(t for t in found if first <= t <= last)
    return TickFilter(nodes, keys, first, last, only)
