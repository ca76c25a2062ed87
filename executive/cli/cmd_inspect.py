"""`cellwright inspect`: what a recording holds, at one tick or change by change."""

import json
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

import click
import typer
from rich.console import Console
from rich.text import Text

from executive.core.errors import InputError
from executive.engine.recording.reader import Recording
from executive.inspector.changes import Change, matching_nodes, status_changes
from executive.inspector.documents import change_document, tick_document
from executive.inspector.stepper import KEYS, Stepper
from executive.inspector.views import ICONS, summary_view, tick_view

# Arrows and the space bar, as terminals send them.
_SAME_AS = {"\x1b[C": "n", "\x1b[D": "p", " ": "n"}


def inspect(
    recording: Annotated[Path, typer.Argument(metavar="RUN", help="Recording of a run.")],
    tick: Annotated[
        int | None, typer.Option(help="Show this tick; -1 is the last. The last by default.")
    ] = None,
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
) -> None:
    """Show what a run did: its outcome, and the tree at a tick with every status and reason.

    On a terminal, keys step through the ticks.
    """
    run = Recording.open(recording)
    nodes = matching_nodes(run.header.nodes, node)
    console = Console(highlight=False, no_color=plain or None)
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


def _tick_number(run: Recording, asked: int | None) -> int:
    count = len(run)
    number = count - 1 if asked is None else asked + count if asked < 0 else asked
    if not 0 <= number < count:
        expected = f"0 to {count - 1}, or -{count} to -1" if count else "a run with ticks in it"
        raise InputError(f"--tick {asked}: no such tick in {run.path}; expected {expected}")
    return number


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
            key = click.getchar()
        except (EOFError, KeyboardInterrupt):
            return


def _asked_number(console: Console) -> int | None:
    text = console.input("tick: ").strip()
    return int(text) if text.isdecimal() else None
