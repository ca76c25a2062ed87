"""`cellwright inspect`: what a recording holds, at one tick or change by change."""

import json
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.text import Text

from executive.cli.console import chatter, results
from executive.cli.inspect_page import serve_page
from executive.cli.recordings import RunArgument
from executive.core.errors import InputError, RecordingError
from executive.engine.recording.reader import Recording
from executive.inspector.changes import Change, matching_nodes, status_changes
from executive.inspector.documents import change_document, tick_document
from executive.inspector.stepper import KEYS, Stepper
from executive.inspector.views import ICONS, summary_view, tick_view

# Arrows and the space bar, as terminals send them.
_SAME_AS = {"\x1b[C": "n", "\x1b[D": "p", " ": "n"}


def inspect(
    recording: RunArgument,
    tick: Annotated[int | None, typer.Option(help="Show this tick; -1 is the last record.")] = None,
    changes: Annotated[
        bool, typer.Option("--changes", help="List every change of status.")
    ] = False,
    node: Annotated[
        str | None, typer.Option(metavar="GLOB", help="Only nodes whose path or name matches.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON on stdout.")] = False,
    plain: Annotated[
        bool, typer.Option("--plain", help="Print and return: no stepping, no colours.")
    ] = False,
    web: Annotated[
        bool,
        typer.Option("--web", help="Serve a page for the browser; live while the run goes on."),
    ] = False,
    host: Annotated[
        str, typer.Option(help="Address of the page; others than this machine's need its token.")
    ] = "127.0.0.1",
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="Port of the page; a free one by default.")
    ] = 0,
    open_browser: Annotated[
        bool, typer.Option("--open/--no-open", help="Open the page in a browser.")
    ] = True,
) -> None:
    """Show what a run did: its outcome, and the tree at a tick with every status and reason.

    On a terminal, keys step through the ticks.
    """
    if web:
        serve_page(recording, chatter(), host=host, port=port, open_browser=open_browser)
        return
    run = _opened(recording)
    nodes = matching_nodes(run.header.nodes, node)
    console = results(colour=not plain)
    if changes:
        _print_changes(console, status_changes(run, nodes), as_json)
        return
    number = _tick_number(run, tick)
    if as_json:
        typer.echo(json.dumps(tick_document(run, number, nodes)))
    elif plain or not (sys.stdin.isatty() and sys.stdout.isatty()):
        console.print(summary_view(run), "", tick_view(run, number, nodes))
    else:
        _step(console, run, number, nodes)


def _opened(path: Path) -> Recording:
    try:
        run = Recording.open(path)
    except RecordingError as error:
        raise InputError(str(error)) from error  # the user named the wrong file
    if len(run) == 0:
        raise InputError(f"{path}: holds no tick; the run was killed before the first one")
    return run


def _tick_number(run: Recording, asked: int | None) -> int:
    count = len(run)
    if asked is None:
        return _last_visited(run)
    number = asked + count if asked < 0 else asked
    if not 0 <= number < count:
        raise InputError(
            f"--tick {asked}: no such tick in {run.path}; expected 0 to {count - 1}, "
            f"or -{count} to -1"
        )
    return number


def _last_visited(run: Recording) -> int:
    """Return the last real tick: after it the runner may have stopped what still ran."""
    last = len(run) - 1
    return last if run.tick(last).visited or last == 0 else last - 1


def _print_changes(console: Console, changes: Iterable[Change], as_json: bool) -> None:
    if as_json:
        typer.echo(json.dumps([change_document(change) for change in changes]))
        return
    for change in changes:
        icon, colour = ICONS[change.new]
        console.print(
            Text.assemble(
                (f"{change.tick:6d} {change.time_s:9.2f} s  ", "bright_black"),
                (f"{icon} {change.new:<8}", colour),
                f"{change.path}  ",
                (change.reason, colour),
            ),
            soft_wrap=True,
        )


def _step(console: Console, run: Recording, number: int, nodes: frozenset[int]) -> None:
    stepper = Stepper(run, number, nodes)
    key = ""
    while key not in ("q", "\x03", "\x04"):
        if key == "g":
            stepper.go_to(_asked_number(console))
        elif key:
            stepper.press(_SAME_AS.get(key, key))
        console.clear()
        console.print(summary_view(run), "", tick_view(run, stepper.number, nodes))
        console.print(Text(f"{KEYS}  {stepper.note}", "bright_black"))
        try:
            key = typer.getchar()
        except (EOFError, KeyboardInterrupt):
            return


def _asked_number(console: Console) -> int | None:
    text = console.input("tick: ").strip()
    return int(text) if text.isdecimal() else None
