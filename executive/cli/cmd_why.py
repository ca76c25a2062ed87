"""`cellwright why`, `why-not`, `why-halted`: what decided, from the root down."""

import json
from typing import Annotated

import typer

from executive.cli.console import results
from executive.cli.recordings import RunArgument
from executive.inspector.answer_view import answer_document, answer_view
from executive.inspector.names import split_at
from executive.inspector.past import PastRun
from executive.inspector.sentences import Answer
from executive.inspector.why import why as why_it_did
from executive.inspector.why import why_ended
from executive.inspector.why_not import why_halted as who_halted
from executive.inspector.why_not import why_not as why_it_did_not

Node = Annotated[
    str,
    typer.Argument(
        metavar="NODE[@TICK]",
        help="Path of a node, the end of one, or a glob; the tick as 41, -1, last or 12.3s.",
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print JSON on stdout.")]


def why(
    recording: RunArgument,
    node: Annotated[
        str | None,
        typer.Argument(
            metavar="NODE[@TICK]",
            help="Path of a node, the end of one, or a glob; the tick as 41, -1, last or 12.3s. "
            "Without one: why the mission ended as it did.",
        ),
    ] = None,
    as_json: Json = False,
) -> None:
    """Say why a node ran, went on, succeeded or failed; by default when it ended last."""
    run = PastRun.open(recording)
    if node is None:
        _print(run, why_ended(run), as_json)
        return
    index, tick = _place(run, node)
    _print(run, why_it_did(run, index, tick), as_json)


def why_not(recording: RunArgument, node: Node, as_json: Json = False) -> None:
    """Say which sibling or guard decided that a node did not run in a tick."""
    run = PastRun.open(recording)
    index, tick = _place(run, node)
    _print(run, why_it_did_not(run, index, run.index.last_tick if tick is None else tick), as_json)


def why_halted(recording: RunArgument, node: Node, as_json: Json = False) -> None:
    """Say who halted a node, and because of what; by default when it was halted last."""
    run = PastRun.open(recording)
    index, tick = _place(run, node)
    _print(run, who_halted(run, index, tick), as_json)


def _place(run: PastRun, text: str) -> tuple[int, int | None]:
    name, at = split_at(text)
    tick = None if at is None else run.names.tick(at)
    # The root, when only a tick is given.
    return (run.names.node(name, tick) if name else 0), tick


def _print(run: PastRun, answer: Answer, as_json: bool) -> None:
    if as_json:
        typer.echo(json.dumps(answer_document(run, answer)))
    else:
        results().print(answer_view(run, answer))
