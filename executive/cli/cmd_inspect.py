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
from executive.core.errors import InputError, recording_named_by_the_user
from executive.engine.recording.reader import Recording
from executive.inspector.changes import Change, matching_nodes, status_changes
from executive.inspector.documents import change_document, tick_document
from executive.inspector.past import open_with_ticks
from executive.inspector.views import ICONS, summary_view, tick_view


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
        bool, typer.Option("--plain", help="Print and return: not interactive, no colours.")
    ] = False,
    web: Annotated[
        bool,
        typer.Option("--web", help="Serve a page for the browser; live while the run goes on."),
    ] = False,
    rerun: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write scene, images and joints for the Rerun viewer."),
    ] = None,
    sheet: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write all looks of the run into one image, .png."),
    ] = None,
    video: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write a video of the table cell, .webm or .mp4."),
    ] = None,
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

    On a terminal, an interactive inspector opens: `?` lists its keys.
    """
    if rerun is not None:
        _write_rerun(recording, rerun)
    _write_pictures(recording, sheet, video)
    if (rerun, sheet, video) != (None, None, None):
        return
    if web:
        serve_page(recording, chatter(), host=host, port=port, open_browser=open_browser)
        return
    if not (plain or as_json or changes) and sys.stdin.isatty() and sys.stdout.isatty():
        _look(recording, tick, node)
        return
    run = open_with_ticks(recording)
    nodes = matching_nodes(run.header.nodes, node)
    console = results(colour=not plain)
    if changes:
        _print_changes(console, status_changes(run, nodes), as_json)
        return
    number = _tick_number(run, tick)
    if as_json:
        typer.echo(json.dumps(tick_document(run, number, nodes)))
    else:
        console.print(summary_view(run), "", tick_view(run, number, nodes))


def _write_rerun(recording: Path, file: Path) -> None:
    from executive.app.views import write_rerun

    with recording_named_by_the_user():
        write_rerun(recording, file)
    chatter().print(f"{file}: look at it with: rerun {file}", soft_wrap=True)


def _write_pictures(recording: Path, sheet: Path | None, video: Path | None) -> None:
    if sheet is None and video is None:
        return
    with recording_named_by_the_user():
        if sheet is not None:
            from executive.inspector.sheet import write_sheet

            write_sheet(recording, sheet)
            chatter().print(f"{sheet}: all looks of the run", soft_wrap=True)
        if video is not None:
            from executive.app.films import write_video

            write_video(recording, video)
            chatter().print(f"{video}: the cell, four times as fast", soft_wrap=True)


def _look(path: Path, tick: int | None, node: str | None) -> None:
    """Look at a recording in the terminal, until the user leaves."""
    from executive.inspector.terminal.app import InspectorApp

    def start(run: Recording) -> tuple[int | None, int]:
        return (
            None if tick is None else _tick_number(run, tick),
            min(matching_nodes(run.header.nodes, node)),
        )

    wrong = InspectorApp(path, start).run()
    if wrong is not None:
        raise InputError(wrong)


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
